"""The plain references take nothing from the code that they check; mutants go where they may."""

import ast
from pathlib import Path

import pytest

NAIVE = Path(__file__).parents[1] / "naive"

# What a user gives, and the names of states: no formula, no number of a rule, no result.
GIVEN = {"shellcut.material": {"Elastic"}, "shellcut.state": {"BROKEN"}}
# Meshes and states to be tried, and the ledger's sums over what a term says itself.
NO_REFERENCES = {"__init__.py", "cases.py", "booking.py"}


@pytest.mark.parametrize(
    "file",
    [one for one in sorted(NAIVE.glob("*.py")) if one.name not in NO_REFERENCES],
    ids=lambda file: file.stem,
)
def test_plain_references_import_nothing_that_they_could_check(file):
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            assert not any(alias.name.startswith("shellcut") for alias in node.names)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("shellcut"):
            assert {alias.name for alias in node.names} <= GIVEN.get(node.module, set())


SOURCE = '''
"""Text 1 + 2."""
def area(a: Annotated[float, Option("mm", above=0.5)], b=2.0):
    """Return 3 - 4."""
    if a < 0.0:
        raise ValueError(f"must be {a + 1}")
    assert b > 0
    if a <= 1e-12 or not b:
        return b
    return a * b - cross(a, b)
'''


def test_mutants_are_where_they_may_be_and_of_every_kind():
    pytest.importorskip("resource")  # no such limits on Windows
    import mutants

    found = set()
    for first, last, text in mutants.mutants_of(SOURCE):
        now = f"{SOURCE[:first]}{text}{SOURCE[last:]}".splitlines()
        (changed,) = set(now) - set(SOURCE.splitlines())
        found.add(changed.strip())
    assert found == {
        'def area(a: Annotated[float, Option("mm", above=0.5)], b=3.0):',
        "if a >= 1e-12 or not b:",
        "if a <= 1e-12 and not b:",
        "if a <= 1e-12 or b:",
        "if (not (a <= 1e-12 or not b)):",
        "pass",
        "return a / b - cross(a, b)",
        "return a * b + cross(a, b)",
        "return (cross(a, b)) - (a * b)",
        "return a * b - cross(b, a)",
    }
