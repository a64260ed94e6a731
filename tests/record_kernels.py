"""Write ``src/shellcut/models/kernels.json``: the kernels that the ready models call.

Each model runs in a process of its own, so that the kernels are its own.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import shellcut
from shellcut.models.warmup import MODELS
from shellcut.numerics.kernel_cache import KernelCache
from shellcut.numerics.signature_text import written

TARGET = Path(shellcut.__file__).parent / "models" / "kernels.json"
SHORT = {
    "opening": {"membrane.mesh": "quick"},
    "guillotine": {},
    "oscillating": {},
    "trouser": {},
}
"""What makes a run of a model short, and calls all of its kernels."""


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


def run(model):
    """Run a ready model and return its kernels."""
    with tempfile.TemporaryDirectory() as folder:
        shellcut.read_model(model, SHORT[model]).build().run(folder)
    return called()


def main():
    """Record all models, or print the kernels of the one that is named."""
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
