"""Give Numba a cache of its own, and order the files of tests.

The cache is named before anything imports Numba. The environment's NUMBA_CACHE_DIR, if given, is
left alone.
"""

import gc
import getpass
import os
import signal
import sys
import tempfile
from pathlib import Path

import pytest

if "NUMBA_CACHE_DIR" not in os.environ:
    assert "numba" not in sys.modules, "numba was imported before its cache could be named"
    cache = Path(tempfile.gettempdir()) / f"shellcut-numba-{getpass.getuser()}"
    os.environ["NUMBA_CACHE_DIR"] = str(cache)

# Several processes share the cores already. Threads of OpenBLAS spin while they wait for one
# another: that took four fifths of the time of the tests of surfaces.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Tests start Python a few hundred times. Where it may write no bytecode into the tree, each start
# would compile four hundred modules, half a second: it writes it beside the kernels.
if os.environ.pop("PYTHONDONTWRITEBYTECODE", ""):
    os.environ["PYTHONPYCACHEPREFIX"] = str(Path(os.environ["NUMBA_CACHE_DIR"]) / "bytecode")

# With nothing compiled two processes should begin with different kernels, or one waits for the
# other: the first with those of the shell, the second with the others, which take no shell. Then
# the longest files, so that no process is left with one of them at the end.
_FIRST = (
    "test_quad_forces.py",
    "test_contact.py",
    "test_checkpoint.py",
    "test_cable.py",
    "test_tool_grid.py",
    "test_cases.py",
    "test_examples.py",
    "test_study.py",
    "test_free_curved.py",
    "test_report.py",
    "test_command_line.py",
    "test_docs.py",
    "test_opening.py",
    "test_two_point_tear.py",
    "test_trouser.py",
    "test_blade_beside_line.py",
    "test_scene.py",
    "test_model_check.py",
    "test_model_file.py",
    "test_quad_frequency.py",
    "test_pages.py",
    "test_model_keys.py",
)


# Compilation makes objects by the million, hardly any of them garbage: at Python's own 700 the
# collector takes a seventh of its time.
gc.set_threshold(20_000, 10, 10)


# Calls of a bound kernel whose arguments are looked at: the first ones, and every n-th later one,
# because finding the types takes longer than most kernels.
_CHECKED_FIRST, _CHECKED_EVERY = 3, 1000


@pytest.fixture(scope="session", autouse=True)
def _kernels_get_the_types_they_were_bound_for():
    """Refuse arguments of bound kernels that these would misread."""
    import numba as nb

    from shellcut.numerics import jit

    bound = jit.bound

    def checked(kernel, *first):
        call, wanted, count = bound(kernel, *first), tuple(map(nb.typeof, first)), 0

        def checked_call(*arguments):
            nonlocal count
            if count < _CHECKED_FIRST or count % _CHECKED_EVERY == 0:
                found = tuple(map(nb.typeof, arguments))
                if found != wanted:
                    pairs = zip(found, wanted, strict=True)
                    differing = [f"{a} after {b}" for a, b in pairs if a != b]
                    raise TypeError(f"a bound kernel was given other types: {', '.join(differing)}")
            count += 1
            return call(*arguments)

        return checked_call

    jit.bound = checked
    yield
    jit.bound = bound


_MOST_GRIDS = 24


@pytest.fixture(scope="session", autouse=True)
def _one_grid_for_equal_tools():
    """Give equal tools one grid of closest triangles: a tenth of a second for every simulation.

    A grid is read-only.
    """
    from shellcut.tool.closest_triangles import ClosestTriangleGrid

    build, known = ClosestTriangleGrid.build, {}

    def built(tool):
        arrays = tool.vertices, tool.triangles, tool.triangle_tooth, tool.flank
        key = tuple(array.tobytes() for array in arrays)
        if key not in known:
            if len(known) >= _MOST_GRIDS:
                del known[next(iter(known))]
            known[key] = build(tool)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ClosestTriangleGrid, "build", staticmethod(built))
        yield


@pytest.fixture(scope="module")
def no_pictures():
    """Runs of the module draw nothing, as where Matplotlib is not installed."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "matplotlib", None)
        yield


def pytest_runtest_teardown():
    """Ignore closed pipes again, as Python does from its start.

    Gmsh, with which some tests mesh, restores the default of C: the next write into the pipe of a
    process that has ended would end this one, without a word.
    """
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_IGN)


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    from shellcut.numerics.jit import on_compilation

    def refuse():
        raise RuntimeError(
            "a module of tests must compile no kernel when it is imported, or the first test waits "
            "for it in every process: make what takes it in a fixture or a function"
        )

    with on_compilation(refuse):
        return (yield)


def pytest_collection_modifyitems(items):
    place = {name: k for k, name in enumerate(_FIRST)}
    items.sort(key=lambda item: place.get(item.path.name, len(_FIRST)))
