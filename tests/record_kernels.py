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
    """Return the kernels that this process has called, with the size of their machine code."""
    found = []
    modules = [m for name, m in sys.modules.items() if name.startswith("shellcut.")]
    kernels = {id(k): k for m in modules for k in vars(m).values() if hasattr(k, "overloads")}
    for kernel in kernels.values():
        cache = kernel._cache
        if not isinstance(cache, KernelCache):
            continue
        names = cache._cache_file._load_index()
        function = kernel.py_func
        for types in kernel.overloads:
            key = cache._index_key(types, kernel.targetctx.codegen())
            size = (Path(cache.cache_path) / names[key]).stat().st_size
            try:
                entry = [f"{function.__module__}:{function.__qualname__}", *map(written, types)]
            except TypeError:  # of a law
                continue
            found.append((size, entry))
    return [entry for _, entry in sorted(found, key=lambda one: (-one[0], one[1][0]))]


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
    lists = {}
    for model in MODELS:
        out = subprocess.run(
            [sys.executable, __file__, model], stdout=subprocess.PIPE, check=True, text=True
        )
        lists[model] = json.loads(out.stdout.splitlines()[-1])
        print(model, len(lists[model]))
    rows = (
        f' "{model}": [\n  ' + ",\n  ".join(map(json.dumps, entries)) + "\n ]"
        for model, entries in lists.items()
    )
    TARGET.write_text("{\n" + ",\n".join(rows) + "\n}\n")


if __name__ == "__main__":
    main()
