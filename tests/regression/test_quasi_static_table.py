"""What a cut costs and gives without inertia: the table of docs/howto/slow.md."""

import pytest

from page_tables import numbers_of, shown, table
from runs import run
from shellcut import guillotine, opening_test

CASES = {
    "guillotine, 0.8 mm quads": lambda share: guillotine(0.8, quasi_static=share),
    "opening test, quick": lambda share: opening_test("quick", quasi_static=share),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_runs_are_those_of_the_page(name, tmp_path):
    _, rows = table("docs/howto/slow.md", "model | `quasi_static`")
    first = [row[0] for row in rows].index(name)
    for row in rows[first : first + 2]:
        share = None if row[1] == "–" else float(row[1])
        summary, _ = run(CASES[name](share), tmp_path / row[1])
        work = summary["tool_work_Nmm"]
        mean = summary.get("force_plateau_N", summary.get("torque_plateau_Nmm"))
        found = (
            summary["n_step"],
            100.0 * summary["kinetic_rel"],
            100.0 * summary["damping_Nmm"] / work,
            mean,
            work,
        )
        told = [text for cell in row[2:] for text in numbers_of(cell)]
        # Steps hang on the pace, which chance changes.
        assert found[0] == pytest.approx(float(told[0]), rel=0.02)
        assert [shown(*pair) for pair in zip(found[1:], told[1:], strict=True)] == told[1:]
