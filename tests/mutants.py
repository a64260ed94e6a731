"""Break one line of the method at a time, and see whether a test fails.

``python tests/mutants.py r.jsonl`` draws mutants of the rooms below at random, the same for the
same ``--seed``. It writes each into a copy of the tree, runs there the published digests and then
the tests of its room until one fails, and adds a line to ``r.jsonl``, with the test that killed it,
or none. It leaves out what
``r.jsonl`` has, so it goes on where it was stopped. ``--list`` only shows the draw. ``--again``
runs those that survived once more, as after new tests; ``--tests FILE ...`` names the tests.

A mutant turns round a comparison, a sum, a product, a sign or ``and``/``or``, swaps two operands or
arguments, changes a number, negates a condition or leaves out the return of a branch. None is in a
docstring, an annotation, a message, an assertion or a check of input that ends in an error. Numbers
below 1e-6 stay: they guard against round-off, and one half as large again does as well. Signs stay
within what gives the same for both, an absolute value, a norm or a square.

A kernel is compiled anew if it reaches the changed function. Where this cannot be seen (laws, and
values made when a module is imported), it is compiled anew if its module imports the changed one.
All others come from a cache without mutants. The first run, of the digests without a mutant, fills
it and must pass.
"""

import argparse
import ast
import json
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import time
from functools import cache
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().with_name("regression")))

import digest_cases

ROOT = Path(__file__).resolve().parents[1]

ID = "place", "column", "line", "was", "is"  # what tells mutants apart in the record
SMALLEST = 1e-6
DIGESTS = "tests/regression/test_same_bits.py::test_the_published_digests"
"""Come first: in half a minute they notice any change of a bit in what their runs reach."""
CPU_SECONDS = 900  # what runs longer is in an endless loop
KINDS = "unit", "verification", "regression"  # folders of tests
EXAMPLES = ["tests/unit/test_doctests.py"]
ROOMS = {
    "mitc4": "quad_forces shell centre_stress quad_frequency small_matrices tip_force "
    "yielding_film statics integrator time_step cut_loads start_check freedoms",
    "cables": "cable cohesive_law joint_slip segment_cables severing time_step edge_radius hold "
    "every_term",
    "contact": "contact border_contact point_contact friction self_contact self_friction "
    "near_nodes rounded_depth start_check blunt_tool time_step every_term",
    "fracture": "crack_meets tip_watch segment_cables tip_force cut_topology cut_state topology "
    "crack_path curved_paths side_tears puncture drawn_film anisotropy options blade_reach "
    "cut_loads every_term severing notch tear_onset running_tears pierced_places",
    "central_difference.py": "integrator load symmetry_plane quasi_static",
    "loads": "load cut_loads symmetry_plane support_pull freedoms integrator statics",
    "material": "material yielding_laws nominal_stress yielding_film new_law shell",
    "simulation": "simulation time_step quasi_static relaxation instability imperfection "
    "force_terms energy_account",
}
TURNED = {
    **{ast.Lt: ">", ast.Gt: "<", ast.LtE: ">=", ast.GtE: "<=", ast.Eq: "!=", ast.NotEq: "=="},
    **{ast.Is: "is not", ast.IsNot: "is", ast.In: "not in", ast.NotIn: "in"},
    **{ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.FloorDiv: "*"},
    **{ast.And: "or", ast.Or: "and"},
}
ORDERED = (ast.Sub, ast.Div, ast.FloorDiv, ast.MatMult, ast.Pow, ast.Mod)
ORDERED_CALLS = {"cross", "arctan2", "atan2", "sub"}
EVEN_CALLS = {"abs", "norm", "hypot", "distance"}


def left_out(node):
    """Return the parts of a node where no mutant goes."""
    match node:
        case ast.Raise() | ast.Assert() | ast.JoinedStr() | ast.Import() | ast.ImportFrom():
            return list(ast.iter_child_nodes(node))
        case ast.AnnAssign() | ast.arg():
            return [node.annotation]
        case ast.FunctionDef():
            return [node.returns, *node.decorator_list]
        case ast.If(body=[*_, ast.Raise()]):
            return [node.test]
        case ast.keyword(arg="strict"):  # of zip: it shows only what is wrong elsewhere
            return [node.value]
        case ast.If(test=ast.Name("TYPE_CHECKING")):
            return [node.test, *node.body]
    return []


def is_even(node):
    """Return whether a node gives the same for both signs of what it takes."""
    match node:
        case ast.Call(func=ast.Name(name) | ast.Attribute(attr=name)):
            return name in EVEN_CALLS
        case ast.BinOp(op=ast.Pow(), right=ast.Constant(value=2)):
            return True
    return False


def mutants_of(source):
    """Yield (first, last, text): a span of the source's bytes, and what takes its place."""
    content, starts = source.encode(), [0]
    for line in content.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def first(node):
        return starts[node.lineno - 1] + node.col_offset

    def last(node):
        return starts[node.end_lineno - 1] + node.end_col_offset

    def text(begin, end):
        return content[begin:end].decode()

    def of(node, parent):
        span = first(node), last(node)
        match node:
            case ast.Compare(left=a, ops=[op], comparators=[b]) if type(op) in TURNED:
                yield from turned(a, op, b)
            case ast.BinOp(left=a, op=op, right=b):
                yield from turned(a, op, b)
                between = text(last(a), first(b))
                swaps = isinstance(op, ORDERED) and not {"(", ")"} & set(between)
                if swaps and not (isinstance(op, ast.Sub) and is_even(parent)):
                    yield *span, f"({text(first(b), last(b))}){between}({text(first(a), last(a))})"
            case ast.BoolOp(op=op, values=values):
                yield from turned(values[0], op, values[1])
            case ast.UnaryOp(op=ast.USub() | ast.Not(), operand=a) if not is_even(parent):
                yield *span, text(first(a), last(a))
            case ast.AugAssign(target=a, op=op, value=b) if type(op) in TURNED:
                yield last(a), first(b), f" {TURNED[type(op)]}= "
            case ast.Constant(value=bool()):
                yield *span, str(not node.value)
            case ast.Constant(value=int()):
                yield *span, str(node.value + 1)
            case ast.Constant(value=float()) if node.value == 0.0 or node.value >= SMALLEST:
                yield *span, repr(1.5 * node.value or 1.0)
            case ast.Call(func=ast.Name(name) | ast.Attribute(attr=name), args=[a, b]):
                if name in ORDERED_CALLS and not is_even(parent):
                    swapped = f"{text(first(b), last(b))}, {text(first(a), last(a))}"
                    yield first(a), last(b), swapped
            case ast.Return() if isinstance(parent, ast.If):
                yield *span, "pass"
        if isinstance(node, ast.If | ast.While | ast.IfExp) and node.test not in left_out(node):
            test = node.test
            yield first(test), last(test), f"(not ({text(first(test), last(test))}))"

    def turned(a, op, b):
        between = text(last(a), first(b))
        if type(op) in TURNED and not {"(", ")"} & set(between):
            yield last(a), first(b), f" {TURNED[type(op)]} "

    def within(node, parent):
        if isinstance(node, ast.expr | ast.stmt):
            yield from of(node, parent)
        yield from below(node)

    def below(node):
        for child in ast.iter_child_nodes(node):
            if child not in left_out(node):
                yield from within(child, node)

    yield from below(ast.parse(source))


def draw(number, seed):
    """Return mutants, each (file, first, last, text), and how many there are to draw from."""
    every = []
    for room in ROOMS:
        path = ROOT / "src/shellcut" / room
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            name = file.relative_to(ROOT).as_posix()
            every += [(name, *one) for one in mutants_of(file.read_text())]
    every = sorted(set(every))
    random.Random(seed).shuffle(every)
    return [one for one in every[: 2 * number] if mutated(*one)][:number], len(every)


def mutated(name, first, last, text):
    """Return the source with a mutant, empty if that is no Python or no change."""
    content = (ROOT / name).read_bytes()
    new = (content[:first] + text.encode() + content[last:]).decode()
    try:
        return "" if ast.dump(ast.parse(new)) == ast.dump(ast.parse(content)) else new
    except SyntaxError:
        return ""


# In the copy, the stamp of a stored kernel: none, or the mutant's if the kernel may reach it.
_STAMP = """
import json
from pathlib import Path
from types import FunctionType

from shellcut.numerics.source_digest import _named_by, _plain, in_package, source_digest

_NOW = json.loads(Path(__file__).with_name("mutant.json").read_text())


def stamp_of(function, is_ours):
    reaches = function.__code__.co_filename in _NOW["reaching"]
    changed = not is_ours or (reaches and _meets(function))
    return (_NOW["mutant"] if changed else "") + ("" if is_ours else source_digest(function))


def _meets(function):
    if _NOW["lines"] is None:
        return True
    first, last = _NOW["lines"]
    found, waiting = set(), [function]
    while waiting:
        one = _plain(waiting.pop())
        if not isinstance(one, FunctionType) or id(one) in found:
            continue
        found.add(id(one))
        code = one.__code__
        if code.co_filename == _NOW["file"] and first <= code.co_firstlineno <= last:
            return True
        if in_package(Path(code.co_filename)):
            waiting += [value for _, value in _named_by(one)]
    return False
"""
_KEPT = ("src", "tests", "docs", "examples", "pyproject.toml", "README.md", "CHANGELOG.md")


def lines_of(name, place):
    """Return the first and last line of the function or class around a place in a file [bytes].

    None if kernels may depend on it without naming it: laws are called by a table, and what is in
    neither, or is called when a module is imported, may make a value that kernels read.
    """
    source = (ROOT / name).read_bytes()
    line = source[:place].count(b"\n") + 1
    for one in ast.parse(source).body:
        is_named = isinstance(one, ast.FunctionDef | ast.ClassDef)
        if is_named and one.lineno <= line <= one.end_lineno:
            above = min([one.lineno, *(of.lineno for of in one.decorator_list)])
            by_table = "material/" in name or one.name in called_by_modules()
            return None if by_table else (above, one.end_lineno)
    return None


@cache
def called_by_modules():
    """Return the names of what is called, directly or not, when modules are imported."""
    found, by_name = set(), {}
    for file in (ROOT / "src/shellcut").rglob("*.py"):
        for one in ast.parse(file.read_text()).body:
            calls = [node.func for node in ast.walk(one) if isinstance(node, ast.Call)]
            names = {func.id for func in calls if isinstance(func, ast.Name)}
            if isinstance(one, ast.FunctionDef | ast.ClassDef):
                by_name.setdefault(one.name, set()).update(names)
            else:
                found |= names
    waiting = list(found)
    while waiting:
        more = by_name.get(waiting.pop(), set()) - found
        found |= more
        waiting += more
    return found


@cache
def imports_of(file):
    """Return the files of shellcut that a file imports."""
    package, found = ROOT / "src/shellcut", []
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.ImportFrom):
            base = file.parents[node.level - 1] if node.level else package.parent
            base = base.joinpath(*(node.module or "").split("."))
            for name in (base, *(base / alias.name for alias in node.names)):
                found += [p for p in (name.with_suffix(".py"), name / "__init__.py") if p.is_file()]
    if file.parent == package / "material":  # laws are in a table
        found += (package / "material").glob("*.py")
    return frozenset(found)


def reaches(file, other):
    """Return whether a file imports another, directly or not, or is it."""
    found, waiting = set(), [file]
    while waiting:
        one = waiting.pop()
        if one == other:
            return True
        if one not in found:
            found.add(one)
            waiting += imports_of(one)
    return False


def tests_for(name):
    """Return the tests of a file: of its name, of its room, and all that import it."""
    file, stem = ROOT / name, Path(name).stem
    room = next(one for one in ROOMS if name.startswith(f"src/shellcut/{one}"))
    every = [p for kind in KINDS for p in sorted((ROOT / "tests" / kind).glob("test_*.py"))]
    named = [p.relative_to(ROOT).as_posix() for p in every if p.stem == f"test_{stem}"]
    importing = [p.relative_to(ROOT).as_posix() for p in every if file in imports_of(p)]
    of_room = [f"tests/unit/test_{one}.py" for one in ROOMS[room].split()]
    both = [one for one in of_room if one in importing]
    return [*dict.fromkeys([*named, of_room[0], *both, *of_room, *importing, *EXAMPLES])]


class Copy:
    """A copy of the tree, and two caches of kernels: one without mutants, one for the present."""

    def __init__(self, folder):
        self.tree, self.good, self.own = folder / "tree", folder / "good", folder / "own"
        shutil.rmtree(self.tree, ignore_errors=True)
        for name in _KEPT:
            if (ROOT / name).is_dir():
                skip = shutil.ignore_patterns("__pycache__")
                shutil.copytree(ROOT / name, self.tree / name, ignore=skip)
            else:
                shutil.copy2(ROOT / name, self.tree / name)
        numerics = self.tree / "src/shellcut/numerics"
        self._change(
            numerics / "kernel_cache.py",
            (
                "source_digest(*([] if is_ours else [self._function]))",
                "stamp_of(self._function, is_ours)",
            ),
            (
                "from .source_digest import",
                "from .mutant import stamp_of\nfrom .source_digest import",
            ),
        )
        # The digest of a law covers every source of shellcut. Without this change each mutant would
        # make all laws new, and all kernels that take them.
        self._change(
            numerics / "source_digest.py",
            (
                "digest.update(path.relative_to(PACKAGE).as_posix().encode() + path.read_bytes())",
                "pass",
            ),
        )
        # Tests run in the order in which they are named.
        self._change(self.tree / "tests/conftest.py", ("items.sort(", "sorted(items, "))
        (numerics / "mutant.py").write_text(_STAMP)
        self._now = numerics / "mutant.json"
        self.good.mkdir(parents=True, exist_ok=True)
        if (said := digest_cases.published()[0]) != f"Versions: {digest_cases.versions()}.":
            raise SystemExit(f"the digests are published for other versions: {said}")
        if failed := self.run([]):
            raise SystemExit(f"{DIGESTS} must pass in the copy without a mutant, got {failed}")

    def _change(self, file, *changes):
        text = file.read_text()
        for before, after in changes:
            if before not in text:
                raise SystemExit(f"{file} has no {before!r} to be replaced in the copy")
            text = text.replace(before, after)
        file.write_text(text)

    def run(self, tests, name="", *change):
        """Run tests with a mutant, or none: return the first that fails, empty if none does."""
        mutant, reaching, lines = f"{name}{change}" if name else "", [], None
        if name:
            lines = lines_of(name, change[0])
            (self.tree / name).write_text(mutated(name, *change))
            files = (ROOT / "src/shellcut").rglob("*.py")
            reaching = [one for one in files if reaches(one, ROOT / name)]
        state = {
            "mutant": mutant,
            "reaching": [str(self.tree / p.relative_to(ROOT)) for p in reaching],
            "file": str(self.tree / name),
            "lines": lines,
        }
        self._now.write_text(json.dumps(state))
        shutil.rmtree(self.own, ignore_errors=True)
        shutil.copytree(self.good, self.own, copy_function=os.link)
        own = {"NUMBA_CACHE_DIR": str(self.own), "PYTHONPATH": str(self.tree / "src")}
        failed = self._failed([DIGESTS], own) or (self._failed(tests, own) if tests else "")
        self._keep_kernels(mutant.encode())
        if name:
            shutil.copy2(ROOT / name, self.tree / name)
        return failed

    def _failed(self, tests, own):
        """Return the first of some tests that fails, empty if none does."""
        command = "-m pytest -x -n 0 -p no:cacheprovider --no-header --tb=line"
        done = subprocess.run(
            [sys.executable, *command.split(), *tests],
            cwd=self.tree,
            env={**os.environ, **own},
            capture_output=True,
            text=True,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS)),
        )
        if done.returncode == 0:
            return ""
        named = re.findall(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.M)
        return (
            named[0] if named else f"exit {done.returncode}: {(done.stdout + done.stderr)[-300:]}"
        )

    def _keep_kernels(self, mutant):
        """Put new kernels that no mutant reaches into the cache of those without."""
        for index in self.own.rglob("*.nbi"):
            known = self.good / index.relative_to(self.own)
            if (mutant and mutant in index.read_bytes()) or (
                known.exists() and known.samefile(index)
            ):
                continue
            known.parent.mkdir(parents=True, exist_ok=True)
            for file in index.parent.glob(f"{index.stem}.*"):
                os.replace(file, known.parent / file.name)


def described(name, first, last, text):
    """Return what a mutant is, the same as long as its line is."""
    content = (ROOT / name).read_bytes()
    line = content[:first].count(b"\n")
    return {
        "place": f"{name}:{line + 1}",
        "column": first - content.rfind(b"\n", 0, first) - 1,
        "line": content.splitlines()[line].decode().strip(),
        "was": content[first:last].decode(),
        "is": text,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("record", type=Path)
    parser.add_argument("--number", type=int, default=100)
    parser.add_argument("--seed", type=int, default=54)
    parser.add_argument("--folder", type=Path, default=ROOT / "build/mutants", help="of the copy")
    parser.add_argument("--only", type=int, nargs="+", help="of the draw")
    parser.add_argument("--tests", nargs="+", help="instead of those of the room")
    parser.add_argument("--again", action="store_true", help="those that survived")
    parser.add_argument("--list", action="store_true", help="show the draw")
    given = parser.parse_args()
    drawn, n_all = draw(given.number, given.seed)
    lines = given.record.read_text().splitlines() if given.record.exists() else []
    known = {tuple(row[name] for name in ID): row for row in map(json.loads, lines)}
    rows, copy = [], None
    for n, mutant in enumerate(drawn):
        row = described(*mutant)
        found = known.get(tuple(row[name] for name in ID), row)
        rows.append(found)
        if given.only is not None and n not in given.only:
            continue
        print(n, *(row[name] for name in ID), sep=" | ", flush=True)
        if not given.list and ("by" not in found or (given.again and not found["by"])):
            copy = copy or Copy(given.folder)
            began = time.perf_counter()
            row["tests"] = given.tests or tests_for(mutant[0])
            row["by"] = copy.run(row["tests"], *mutant)
            row["seconds"] = round(time.perf_counter() - began)
            rows[-1] = row
            with given.record.open("a") as file:
                file.write(json.dumps(row) + "\n")
        if "by" in rows[-1]:
            print(
                "   ", f"killed by {rows[-1]['by']}" if rows[-1]["by"] else "survived", flush=True
            )
    tried = [row for row in rows if "by" in row]
    killed = sum(bool(row["by"]) for row in tried)
    print(f"{killed} of {len(tried)} killed, {len(rows) - len(tried)} of the draw not tried yet")
    print(f"drawn from {n_all}")


if __name__ == "__main__":
    main()
