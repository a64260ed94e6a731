"""Write ``src/shellcut/models/kernels.json``: the kernels that the models call.

Each model runs in a process of its own, so that the kernels are its own.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import shellcut
from free_model import FREE
from shellcut.models.warmup import MODELS
from shellcut.numerics.kernel_cache import KernelCache
from shellcut.numerics.signature_text import written
from shellcut.recording import pictures

TARGET = Path(shellcut.__file__).parent / "models" / "kernels.json"
QUICK = {"membrane.mesh": "quick"}
SHORT = {
    "opening": ("opening", QUICK),
    "guillotine": ("guillotine", {}),
    "oscillating": ("oscillating", {}),
    "trouser": ("trouser", {}),
    "free": (FREE.replace("[1, 0, 0]", "[1, 0.1, 0]"), {}),
}
"""A run of each model that is short, and calls all of its kernels."""
BRIEF = {**QUICK, "motion.angle_deg": 25.0, "motion.duration": "1.6 ms"}
RUBBED = {"friction": 0.2, "self_contact": True, "self_friction": 0.2}
SOME = {"motion.travel": "3 mm"}
VOCE = {
    "material.hardening.yield_stress": 10.0,
    "material.hardening.gain": 5.0,
    "material.hardening.strain": 0.1,
}
WITH_OPTIONS = {
    "through quads": ("guillotine", {"fracture.path": "free", "motion.travel": "6 mm"}),
    "opening through quads": ("opening", {**BRIEF, "fracture.path": "free"}),
    "friction": ("guillotine", {f"contact.{key}": value for key, value in RUBBED.items()}),
    "ldpe, opening": ("opening", {**BRIEF, "material": "ldpe"}),
    "ldpe, through quads": (FREE, {"material": "ldpe"}),
    "Voce": ("guillotine", VOCE | SOME),
    **{
        name: ("guillotine", {"material": name, **SOME})
        for name in ("ldpe", "pet", "aluminium_foil", "foil_ldpe")
    },
}
"""Runs with options of which a release brings the kernels, too."""


def called():
    """Return the kernels that this process has called, with the size of their machine code [B]."""
    found = []
    for place, kernel in _kernels():
        cache = kernel._cache
        files = cache._cache_file._load_index()
        for types in kernel.overloads:
            key = cache._index_key(types, kernel.targetctx.codegen())
            size = (Path(cache.cache_path) / files[key]).stat().st_size
            try:
                entry = [place, *map(written, types)]
            except TypeError:  # of a law
                continue
            found.append((size, entry))
    return found


def listed(model):
    """Return the kernels in the list of a model, as text."""
    rows = json.loads(TARGET.read_text())
    return {json.dumps(entry) for models, *entry in rows if model in models}


def _kernels():
    """Yield the place, "module:name", of each kernel and the kernel."""
    for name, module in list(sys.modules.items()):
        for inside, thing in vars(module).items() if name.startswith("shellcut.") else ():
            if (
                isinstance(getattr(thing, "_cache", None), KernelCache)
                and thing.py_func.__module__ == name
            ):
                yield f"{name}:{inside}", thing


def draw_here():
    """Let runs draw their pictures in this process, which calls the kernels of these, too."""

    def no_process():
        raise OSError

    pictures.Child = no_process


def run(name):
    """Carry out one of the runs and return its kernels."""
    draw_here()
    model, settings = (SHORT | WITH_OPTIONS)[name]
    with tempfile.TemporaryDirectory() as folder:
        if "\n" in model:  # the text of a file
            text, model = model, Path(folder) / "free.toml"
            model.write_text(text)
        shellcut.read_model(model, settings).build().run(Path(folder) / "out", progress=False)
    return called()


def main():
    """Record all models, or print the kernels of the run that is named."""
    if sys.argv[1:]:
        print(json.dumps(run(sys.argv[1])))
        return
    sizes, models_of = {}, {}
    for model in MODELS:
        out = subprocess.run(
            [sys.executable, __file__, model], stdout=subprocess.PIPE, check=True, text=True
        )
        for size, entry in json.loads(out.stdout.splitlines()[-1]):
            sizes[json.dumps(entry)] = size
            models_of.setdefault(json.dumps(entry), []).append(model)
    rows = sorted(sizes, key=lambda entry: (-sizes[entry], entry))
    lines = [json.dumps([models_of[entry], *json.loads(entry)]) for entry in rows]
    TARGET.write_text("[\n" + ",\n".join(lines) + "\n]\n")
    print(f"{len(rows)} kernels in {TARGET}")


if __name__ == "__main__":
    main()
