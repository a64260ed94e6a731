"""History files: exact numbers, whole lines whatever happens, units beside the names."""

import re

import numpy as np
import pytest

from shellcut.results.history import HistoryWriter, Written, read_history, read_splits, write_splits
from shellcut.state import SplitRecord
from small_disk import REFUSAL, files_of_at_most

COLUMNS = (("time", "s"), ("angle", "deg"), ("torque", "N*mm"))


def row(k):
    return {"torque": np.sin(k) * 1e3, "time": 1e-7 * k, "angle": k / 3.0}


@pytest.fixture
def path(tmp_path):
    return tmp_path / "history.csv"


def write(path, first=0, end=8, *, kept=None, until=None):
    """Write rows to a history; return what was written after ``until`` of them, or all."""
    with HistoryWriter(path, COLUMNS, kept=kept) as history:
        for k in range(first, end):
            history.append(row(k))
            if until in (None, k + 1):
                written = history.written
    return written


def test_what_was_written_is_read_to_the_last_bit_and_a_new_run_replaces_it(path):
    write(path, 90, 99)
    written = write(path, 0, 50)
    assert written.length == path.stat().st_size
    assert path.read_text().splitlines()[0] == "time [s],angle [deg],torque [N*mm]"
    values, units = read_history(path)
    assert list(values) == ["time", "angle", "torque"]
    assert units == dict(COLUMNS)
    for name, column in values.items():
        np.testing.assert_array_equal(column, [row(k)[name] for k in range(50)])


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ((), "at least one"),
        ((("time", "s"), ("time", "ms")), r"\['time'\] come twice"),
        ((("time,", "s"),), "got 'time,'"),
        ((("ratio", ""),), "got ''"),
    ],
)
def test_columns_that_cannot_stand_in_a_header_are_refused(path, columns, message):
    with pytest.raises(ValueError, match=message):
        HistoryWriter(path, columns)


def test_continuing_from_a_checkpoint_equals_the_uninterrupted_run(path, tmp_path):
    broken = tmp_path / "broken.csv"
    write(path, 0, 20)
    kept = write(broken, 0, 14, until=10)
    with broken.open("a") as file:  # the last line of a full disk
        file.write("1.4e-06,4.6")
    assert len(read_history(broken)[0]["time"]) == 14
    write(broken, 10, 20, kept=kept)
    assert path.read_bytes() == broken.read_bytes()


def test_other_columns_and_foreign_files_are_refused(path):
    HistoryWriter(path, COLUMNS).close()
    with pytest.raises(ValueError, match=r"has other columns than this run: 'time \[s\]"):
        HistoryWriter(path, COLUMNS[:2], kept=Written(30, ""))
    path.write_text("a;b\n1;2\n")
    with pytest.raises(ValueError, match="line 1: must name the columns"):
        read_history(path)
    with HistoryWriter(path, COLUMNS) as history, pytest.raises(KeyError, match="torque"):
        history.append({"time": 0.0, "angle": 0.0, "torqe": 0.0})
    assert len(path.read_text().splitlines()) == 1


def test_a_row_that_does_not_fit_is_told_of(path):
    with HistoryWriter(path, COLUMNS) as writer:
        writer.append(row(0))
        # The system takes the first bytes of the row, and says so without an error.
        whole = path.stat().st_size
        with files_of_at_most(whole + 5), pytest.raises(OSError, match=REFUSAL):
            writer.append(row(1))
        assert path.stat().st_size == whole + 5
        assert writer.written.length == whole
        kept = writer.written
    write(path, 2, 3, kept=kept)
    assert read_history(path)[0]["time"].tolist() == [0.0, 2e-7]


CHANGES = {
    "a number": lambda line: line.replace(b"0", b"5", 1),
    "a bad cell": lambda line: b"x" + line[1:],
    "a bit": lambda line: line[:3] + bytes([line[3] ^ 0x80]) + line[4:],
    "a line twice": lambda line: line + line,
    "a line lost": lambda line: b"",
    "a line of Windows": lambda line: line.replace(b"\n", b"\r\n"),
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("line", [1, 5])
def test_a_kept_part_that_has_been_changed_is_refused(path, change, line):
    kept = write(path, until=6)
    lines = path.read_bytes().splitlines(keepends=True)
    lines[line] = CHANGES[change](lines[line])
    changed = b"".join(lines)
    path.write_bytes(changed)
    with pytest.raises(ValueError, match=r"history\.csv must be as it was at the checkpoint"):
        HistoryWriter(path, COLUMNS, kept=kept)
    assert path.read_bytes() == changed  # nothing is lost


def test_what_comes_after_the_kept_part_may_be_anything(path):
    kept = write(path, until=6)
    whole = path.read_bytes()
    for rest in (b"", b"1.0,x,", b"\xff\xfe\n", whole):
        path.write_bytes(whole[: kept.length] + rest)
        write(path, 6, 8, kept=kept)
        assert path.read_bytes() == whole
    path.write_bytes(whole[: kept.length - 1])
    with pytest.raises(ValueError, match=f"must reach to .* that is have {kept.length} bytes"):
        HistoryWriter(path, COLUMNS, kept=kept)


@pytest.mark.parametrize("cell", ["x", "", "1.2.3", "1e", "\x00", "\ufffd", "0x10"])
@pytest.mark.parametrize("column", [0, 2])
def test_a_cell_that_is_no_number_is_named(path, cell, column):
    write(path)
    lines = path.read_text().splitlines()
    cells = lines[4].split(",")
    cells[column] = cell
    lines[4] = ",".join(cells)
    path.write_text("\n".join(lines) + "\n")
    name, unit = COLUMNS[column]
    said = f"{path}, line 5, column '{name} [{unit}]': must be a number, got {cell!r}"
    with pytest.raises(ValueError, match=re.escape(said)):
        read_history(path)


def test_what_a_blown_up_run_writes_is_read(path):
    with HistoryWriter(path, COLUMNS) as history:
        history.append({"time": 0.0, "angle": np.nan, "torque": -np.inf})
    values, _ = read_history(path)
    assert np.isnan(values["angle"][0])
    assert values["torque"][0] == -np.inf


@pytest.mark.parametrize(
    ("column", "cell", "said"),
    [
        ("time [s]", "x", "must be a number, got 'x'"),
        ("node [-]", "1.5", "must be an integer, got '1.5'"),
        ("twin [-]", "9" * 30, "must be an integer, got '999"),
        ("X_end [mm]", "", "must be a number, got ''"),
    ],
)
def test_a_cell_of_the_splits_that_is_no_number_is_named(tmp_path, column, cell, said):
    path, place = tmp_path / "splits.csv", (0.0, 1.0, 2.0)
    record = SplitRecord(1e-3, 4, 5, place, place, place, "blade", 1.0, 0.5)
    write_splits(path, [record, record])
    columns, _ = read_splits(path)
    assert columns["node"].tolist() == [4, 4]
    header, first, second = path.read_text().splitlines()
    cells = second.split(",")
    cells[header.split(",").index(column)] = cell
    for text, refused in (
        (f"{header}\n{first}\n{','.join(cells)}\n", f"{path}, line 3, column '{column}': {said}"),
        (f"{header}\n{first},1\n", "splits.csv, line 2: must have 19 cells, got 20"),
        ("", "splits.csv, line 1: must name the columns"),
        ("a,b\n1,2\n", "splits.csv, line 1: must name the columns"),
    ):
        path.write_text(text)
        with pytest.raises(ValueError, match=re.escape(refused)):
            read_splits(path)
