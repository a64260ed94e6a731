"""Nothing that makes the state depends on the processor: shellcut.arrays says what would.

Then the digest of a law's sources, by which Numba's cache tells one version of a law from another.
"""

import ast
import enum
import importlib.util
import math
import sys
from collections import namedtuple
from dataclasses import replace
from pathlib import Path

import numba
import numpy as np
import pytest

import shellcut
from shellcut import CowperSymonds, Elastic, JohnsonCook, Linear
from shellcut.material import LAWS, Plastic, PointLaw, register
from shellcut.material.rate_factor import RateFactor
from shellcut.material.return_mapping import make_flow
from shellcut.numerics.source_digest import NOT_STORED

PACKAGE = Path(shellcut.__file__).parent

BESIDE = {
    "command_line": "starts runs",
    "files": "no numbers",
    "report": "reads results",
    "results": "reads results",
    "scene_page": "draws results",
    "statics": "states at rest of their own, by SciPy's solvers; no run begins with them",
    "study": "plans runs and reads results",
    "view": "draws results",
    "card.py": "shows objects in notebooks",
    "tensile.py": "evaluates tensile tests",
    "checks/hold.py": "a doubt about supports",
    "checks/path.py": "a doubt about the path",
    "checks/plausible.py": "doubts about units",
    "checks/strength.py": "doubts about a film that is tight, yields or is held by glue",
    "material/material_point.py": "stress of a point by itself, of no film",
    "material/nominal_stress.py": "curves of tensile tests",
    "tool/touching_bodies.py": "accepts tools or refuses them",
    "numerics/lane_exponentials.py": "the plain forms that only tests of kernels call",
}
"""Rooms and files that are not on the way, with what they are for."""

EXPECTED = {
    "fracture/tip_force.py": ["@"],  # a sparse matrix, by SciPy's own loops
    "unit.py": ["factor ** power"],  # of fractions
}
"""What is left in a file."""

OF_BLAS = {"matmul", "dot", "vdot", "inner", "tensordot", "polyfit", "cov", "corrcoef"}
OF_NUMPY = {
    *("exp", "exp2", "expm1", "log", "log2", "log10", "log1p", "power", "float_power", "cbrt"),
    *("sin", "cos", "tan", "arcsin", "arccos", "arctan", "arctan2", "angle", "sinc"),
    *("sinh", "cosh", "tanh", "arcsinh", "arccosh", "arctanh", "logaddexp", "geomspace"),
}
SORTS = {"argsort", "argpartition", "partition"}
OF_SCIPY = {"CubicSpline", "RotationSpline", "PchipInterpolator", "make_interp_spline"}
OF_SCIPY |= {"RBFInterpolator", "least_squares", "minimize"}


def is_compiled(node):
    marks = " ".join(map(ast.unparse, node.decorator_list))
    return "kernel" in marks or "inline" in marks


def exposed(tree):
    """Yield what is called, or read, in plain Python."""
    todo = [tree]
    while todo:
        node = todo.pop()
        if isinstance(node, ast.FunctionDef) and is_compiled(node):
            continue
        todo += ast.iter_child_nodes(node)
        if isinstance(node, (ast.BinOp, ast.AugAssign)):
            if isinstance(node.op, ast.MatMult):
                yield "@"
            power = node.right if isinstance(node, ast.BinOp) else node.value
            if isinstance(node.op, ast.Pow) and not is_plain_power(node, power):
                yield ast.unparse(node)
        elif isinstance(node, ast.Call):
            name = ast.unparse(node.func)
            given = {keyword.arg for keyword in node.keywords}
            of, _, last = name.rpartition(".")
            if (last == "argsort" or (of == "np" and last in SORTS)) and not any(
                k.arg == "kind" and ast.unparse(k.value) == "'stable'" for k in node.keywords
            ):
                yield last
            elif name == "np.linalg.norm" and "axis" in given and len(node.args) == 1:
                continue  # a plain sum
            elif of in ("np.linalg", "scipy.linalg"):
                yield name
            elif last == "einsum" and "optimize" in given:
                yield "einsum by BLAS"
            elif (of == "np" and last in OF_BLAS | OF_NUMPY) or (of and last == "dot"):
                yield name
            elif name.startswith("scipy.") and last in OF_SCIPY:
                yield last


def is_plain_power(node, power):
    """Whether it is a square, or of numbers in the source or of Python's own."""
    if ast.unparse(power) in ("2", "0.5"):
        return True
    return isinstance(node, ast.BinOp) and isinstance(node.left, ast.Constant)


SOURCES = {
    str(path.relative_to(PACKAGE)): path
    for path in sorted(PACKAGE.rglob("*.py"))
    if not BESIDE.keys() & {path.relative_to(PACKAGE).parts[0], str(path.relative_to(PACKAGE))}
}


def test_no_source_on_the_way_depends_on_the_processor():
    found = {
        name: sorted(exposed(ast.parse(path.read_text(encoding="utf-8"))))
        for name, path in SOURCES.items()
    }
    assert {name: calls for name, calls in found.items() if calls} == EXPECTED


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a @ b", ["@"]),
        ("np.linalg.norm(x)", ["np.linalg.norm"]),
        ("np.linalg.norm(x, axis=1)", []),
        ("np.linalg.norm(x, 2, axis=1)", ["np.linalg.norm"]),
        ("np.linalg.inv(A)", ["np.linalg.inv"]),
        ("x.dot(y)", ["x.dot"]),
        ("np.einsum('i,i->', x, y, optimize=True)", ["einsum by BLAS"]),
        ("np.exp(x) + np.sqrt(x) + np.hypot(x, y)", ["np.exp"]),
        ("x**2 + x**3", ["x ** 3"]),
        ("x.argsort()", ["argsort"]),
        ("np.argsort(x, kind='stable')", []),
        ("@kernel\ndef f(x):\n    return np.exp(x) ** 3", []),
    ],
)
def test_it_sees_what_depends(text, said):
    assert list(exposed(ast.parse(text))) == said


FOIL = Elastic(70_000.0, 0.33, 2.7e-9)
LAW = """
from helpers import moduli
import more_helpers
def stress(p, strain, history, dt):
    return moduli(p, strain), 0.0, 0.0, history
def thickness_stretch(p, strain, history):
    return more_helpers.one()
"""
FILES = {
    "deep": "FACTOR = 2.0\ndef scale(strain):\n    return (FACTOR * strain[0], 0.0, 0.0)\n",
    "aside": "def other():\n    return 0.0\n",
    "helpers": "from deep import scale\ndef moduli(p, strain):\n    return scale(strain)\n",
    "more_helpers": "def one():\n    return 1.0\n",
    "law": LAW,
}


def _law_in(folder, monkeypatch):
    """Import the files of a folder anew and make the law."""
    for name in FILES:
        spec = importlib.util.spec_from_file_location(name, folder / f"{name}.py")
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, name, module)
        spec.loader.exec_module(module)
    return PointLaw("one of a test", module.stress, module.thickness_stretch)


def test_an_edit_of_any_module_that_a_law_calls_changes_its_digest(tmp_path, monkeypatch):
    digests = {}
    for edited in ("nothing", *FILES):
        folder = tmp_path / edited
        folder.mkdir()
        for name, text in FILES.items():
            (folder / f"{name}.py").write_text(text + "# another version\n" * (name == edited))
        digests[edited] = _law_in(folder, monkeypatch).digest
    same = [edited for edited, digest in digests.items() if digest == digests["nothing"]]
    assert same == ["nothing", "aside"]


def test_functions_that_kernels_call_have_names_of_their_own_in_each_law():
    # Kernels from Numba's cache are linked by these names.
    made = [
        make_flow(rate.function, rate is not RateFactor, n_mode)
        for rate in (RateFactor, JohnsonCook, CowperSymonds)
        for n_mode in (2, 3)
    ]
    names = {getattr(one, "py_func", one).__qualname__ for one in made}
    assert len(names) == len(made)


def test_functions_without_a_file_count_by_their_code():
    def digest(lost):
        space = {}
        exec(f"def stress(p, strain, history, dt): return strain, {lost}, 0.0, history", space)
        return PointLaw("typed in", space["stress"], space["stress"]).digest

    assert digest("0.0") == digest("0.0") != digest("1.0")


class Holding:
    def __init__(self, value):
        self.value = value


def reading(value):
    """Return a law whose function reads a value: in a cell, and of what is there by its name."""

    def stress(p, strain, history, dt):
        return value, value.k

    return PointLaw("reading", stress, stress)


def times(k):
    return lambda x: k * x


@pytest.mark.parametrize(
    "made",
    [
        lambda k: (1.0, times(k)),
        lambda k: [times(k)],
        lambda k: {"one": k},
        lambda k: {k},
        lambda k: type("Of", (), {"k": k}),
        lambda k: type("Of", (type("Base", (), {"k": k}),), {}),
        lambda k: type("Of", (), {"k": staticmethod(times(k))}),
        lambda k: namedtuple("Of", "k", defaults=[k]),
        lambda k: namedtuple("Of", "k")(k),
        lambda k: enum.IntEnum("Of", {"k": int(k)}),
        lambda k: np.float64(k),
        lambda k: np.array([1.0, k]),
        lambda k: np.array([(1, k)], dtype=[("n", int), ("k", float)]),
        lambda k: np.arange(3) if k == 1.0 else np.arange(3.0),
        lambda k: f"{k}",
        lambda k: complex(k, 1.0),
        lambda k: math.nan if k == 1.0 else 0.0,
        lambda k: -0.0 if k == 1.0 else 0.0,
        lambda k: 1 if k == 1.0 else True,
        lambda k: math.sin if k == 1.0 else math.cos,
        lambda k: np.sin if k == 1.0 else np.cos,
    ],
)
def test_the_digest_of_a_law_tells_the_values_apart_that_it_reads(made):
    one, again, other = (reading(made(k)).digest for k in (1.0, 1.0, 2.0))
    assert one == again != other
    assert NOT_STORED not in one


def test_a_value_without_a_digest_counts_in_this_process_only():
    one, other = Holding(1.0), Holding(1.0)
    law = reading(one)
    assert NOT_STORED in law.digest
    assert reading(one).digest == law.digest != reading(other).digest


def test_all_laws_of_shellcut_are_stored():
    films = [Plastic(FOIL, Linear(20.0), r_values) for r_values in (None, (0.8, 1.2, 1.6))]
    laws = [
        one.law for film in films for one in (film, replace(film, rate=CowperSymonds(1.0, 5.0)))
    ]
    for law in (*laws, *LAWS.values()):
        if law.stress.__module__.startswith("shellcut"):
            assert NOT_STORED not in law.digest, law.name


def test_a_law_of_another_closure_is_refused_by_name_and_a_changed_value_by_its_use():
    def made(name):
        def stress(p, strain, history, dt):
            return (k[0] * strain[0], 0.0, 0.0), 0.0, 0.0, history

        k = [1.0]
        return k, PointLaw(name, stress, lambda p, strain, history: 1.0)

    k, law = made("of a factory")
    k[0] = 2.0  # before its first use: this is what is compiled
    assert register(law) is law
    numba.typeof(law)
    _, other = made("of a factory")
    with pytest.raises(ValueError, match="already registered, with other functions or other val"):
        register(other)
    with pytest.raises(ValueError, match="already registered"):
        numba.typeof(other)  # nor is it run without being registered
    k[0] = 3.0
    with pytest.raises(ValueError, match="read another value than when it was used first"):
        numba.typeof(law)
    del LAWS["of a factory"]
