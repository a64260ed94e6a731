"""`shellcut verify`: the same, or the first difference; what is refused; nothing is changed."""

import json
import shutil

import pytest

from shellcut.command_line import main
from shellcut.model_file.model import _signed
from shellcut.models import Case
from shellcut.simulation.instability import UnstableStep
from tiny_study import SETTINGS, in_words

pytestmark = pytest.mark.usefixtures("no_pictures")


@pytest.fixture(scope="module")
def done(no_pictures, tmp_path_factory):
    """Return the folder of a run that has ended."""
    out = tmp_path_factory.mktemp("verify") / "out"
    assert main(["run", "guillotine", *in_words(SETTINGS), "-o", str(out)]) == 0
    return out


@pytest.fixture
def out(done, tmp_path):
    return shutil.copytree(done, tmp_path / "out")


def files(folder):
    return {p.name: (p.read_bytes(), p.stat().st_mtime_ns) for p in folder.iterdir()}


def changed(path, line, column, value):
    """Put a value in the place of a cell, both counted from 0; return what was there."""
    rows = [row.split(b",") for row in path.read_bytes().split(b"\n")]
    was, rows[line][column] = rows[line][column], value.encode()
    path.write_bytes(b"\n".join(b",".join(row) for row in rows))
    return was.decode()


def test_a_run_is_the_same_and_its_folder_is_left_as_it_is(out, capsys):
    before = files(out)
    assert main(["verify", str(out)]) == 0
    digest = json.loads((out / "summary.json").read_text())["digest"]
    said, _ = capsys.readouterr()
    assert said.endswith(f"the same: history.csv, splits.csv and digest {digest}\n")
    assert files(out) == before


def test_a_run_that_was_forced_is_forced_again(tmp_path, capsys):
    argv = ["run", "guillotine", *in_words(SETTINGS | {"young": 10}), "-o", str(tmp_path)]
    assert main(argv) == 2
    assert main([*argv, "--force"]) == 0
    assert main(["verify", str(tmp_path)]) == 0
    assert "the same: " in capsys.readouterr().out


def test_the_first_difference_is_said_with_line_column_unit_and_both_values(out, capsys):
    headings = (out / "history.csv").read_text().split("\n")[0].split(",")
    column = headings.index("force [N]")
    was = changed(out / "history.csv", 200, column, "0.25")
    changed(out / "history.csv", 201, column, "0.5")
    of_split = changed(out / "splits.csv", 1, 1, "7")
    assert main(["verify", str(out)]) == 4
    said, _ = capsys.readouterr()
    values = f"0.25 before, {was} in the new run\n"
    assert f"different: history.csv, line 201, force [N]: {values}" in said
    assert f"splits.csv, line 2, node [-]: 7 before, {of_split} in the new run\n" in said
    assert "line 202" not in said
    assert "digest:" not in said


def test_rows_that_are_missing_and_another_digest_are_differences(out, capsys):
    *rows, last, end = (out / "history.csv").read_text().split("\n")
    (out / "history.csv").write_text("\n".join([*rows, end]))
    summary = json.loads((out / "summary.json").read_text())
    digest, summary["digest"] = summary["digest"], "0" * 64
    (out / "summary.json").write_text(json.dumps(summary))
    assert main(["verify", str(out)]) == 4
    said, _ = capsys.readouterr()
    first = f"line {len(rows) + 1}, time [s]: nothing before, {last.split(',')[0]} in the new run"
    assert first in said
    assert f"digest: {'0' * 64} before, {digest} in the new run" in said


def test_a_new_run_that_stops_is_a_difference(out, capsys, monkeypatch):
    def stopped(case, recorder):
        recorder.close()
        raise UnstableStep("a node is too fast")

    monkeypatch.setattr(Case, "go", stopped)
    assert main(["verify", str(out)]) == 4
    assert "but the new run stopped: a node is too fast" in capsys.readouterr().out


def another_version(out):
    used = out / "used.toml"
    body = used.read_text().split("\n", 2)[-1]
    used.write_text(_signed(body.replace("# shellcut ", "# shellcut 0.1.7", 1)))


def changed_model(out):
    used = out / "used.toml"
    used.write_text(used.read_text().replace("travel = 2", "travel = 3"))


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (shutil.rmtree, "there is no such folder"),
        (lambda out: (out / "used.toml").unlink(), "it is not a folder of shellcut run"),
        (lambda out: (out / "summary.json").unlink(), "continues it"),
        (lambda out: (out / "history.csv").unlink(), "history.csv: No such file"),
        (another_version, "with the version of shellcut that wrote it, 0.1.7"),
        (changed_model, "used.toml has been changed since the run began"),
    ],
)
def test_what_cannot_be_verified_is_refused_in_words(out, capsys, damage, said):
    damage(out)
    assert main(["verify", str(out)]) == 2
    error = capsys.readouterr().err
    assert error.startswith("refused:")
    assert said in error
