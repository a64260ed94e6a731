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


def test_what_was_written_is_read_to_the_last_bit(tmp_path):
    path = tmp_path / "history.csv"
    with HistoryWriter(path, COLUMNS) as history:
        for k in range(50):
            history.append(row(k))
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
def test_columns_that_cannot_stand_in_a_header_are_refused(tmp_path, columns, message):
    with pytest.raises(ValueError, match=message):
        HistoryWriter(tmp_path / "history.csv", columns)


def test_a_new_run_replaces_the_old_file_and_a_continued_one_appends(tmp_path):
    path = tmp_path / "history.csv"
    written = None
    for goes_on, first in ((False, 0), (False, 10), (True, 20)):
        with HistoryWriter(path, COLUMNS, kept=written if goes_on else None) as history:
            for k in range(first, first + 10):
                history.append(row(k))
            written = history.written
    assert written.length == path.stat().st_size
    np.testing.assert_array_equal(read_history(path)[0]["angle"], np.arange(10, 30) / 3.0)


def test_continuing_from_a_checkpoint_equals_the_uninterrupted_run(tmp_path):
    whole, broken = tmp_path / "whole.csv", tmp_path / "broken.csv"
    with HistoryWriter(whole, COLUMNS) as history:
        for k in range(20):
            history.append(row(k))
    with HistoryWriter(broken, COLUMNS) as history:
        for k in range(14):
            history.append(row(k))
            if k == 9:
                kept = history.written
    with broken.open("a") as file:  # the last line of a full disk
        file.write("1.4e-06,4.6")
    assert len(read_history(broken)[0]["time"]) == 14
    with HistoryWriter(broken, COLUMNS, kept=kept) as history:
        for k in range(10, 20):
            history.append(row(k))
    assert whole.read_bytes() == broken.read_bytes()


def test_other_columns_and_foreign_files_are_refused(tmp_path):
    path = tmp_path / "history.csv"
    HistoryWriter(path, COLUMNS).close()
    with pytest.raises(ValueError, match=r"has other columns than this run: 'time \[s\]"):
        HistoryWriter(path, COLUMNS[:2], kept=Written(30, ""))
    path = tmp_path / "other.csv"
    path.write_text("a;b\n1;2\n")
    with pytest.raises(ValueError, match="line 1: must name the columns"):
        read_history(path)
    with HistoryWriter(path, COLUMNS) as history, pytest.raises(KeyError, match="torque"):
        history.append({"time": 0.0, "angle": 0.0, "torqe": 0.0})
    assert len(path.read_text().splitlines()) == 1


def test_a_row_that_does_not_fit_is_told_of(tmp_path):
    path = tmp_path / "h.csv"
    with HistoryWriter(path, [("time", "s"), ("torque", "N*mm")]) as writer:
        writer.append({"time": 0.0, "torque": 1.0})
        # The system takes the first bytes of the row, and says so without an error.
        whole = path.stat().st_size
        with files_of_at_most(whole + 5), pytest.raises(OSError, match=REFUSAL):
            writer.append({"time": 0.125, "torque": 2.0})
        assert path.stat().st_size == whole + 5
        assert writer.written.length == whole
        kept = writer.written
    with HistoryWriter(path, [("time", "s"), ("torque", "N*mm")], kept=kept) as writer:
        writer.append({"time": 0.25, "torque": 3.0})
    assert read_history(path)[0]["time"].tolist() == [0.0, 0.25]


def _history(path):
    with HistoryWriter(path, COLUMNS) as history:
        for k in range(8):
            history.append(row(k))
            if k == 5:
                kept = history.written
    return kept


CHANGES = {
    "a number": lambda line: line.replace(b"0", b"5", 1),
    "a bad cell": lambda line: b"x" + line[1:],
    "a bit": lambda line: line[:3] + bytes([line[3] ^ 0x80]) + line[4:],
    "a comma for a point": lambda line: line.replace(b".", b",", 1),
    "a line twice": lambda line: line + line,
    "a line lost": lambda line: b"",
    "a blank": lambda line: b" " + line,
    "a line of Windows": lambda line: line.replace(b"\n", b"\r\n"),
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("line", [1, 4, 5])
def test_a_kept_part_that_has_been_changed_is_refused(tmp_path, change, line):
    path = tmp_path / "history.csv"
    kept = _history(path)
    lines = path.read_bytes().splitlines(keepends=True)
    lines[line] = CHANGES[change](lines[line])
    changed = b"".join(lines)
    path.write_bytes(changed)
    with pytest.raises(ValueError, match=r"history\.csv must be as it was at the checkpoint"):
        HistoryWriter(path, COLUMNS, kept=kept)
    assert path.read_bytes() == changed  # nothing is lost


def test_what_comes_after_the_kept_part_may_be_anything(tmp_path):
    path = tmp_path / "history.csv"
    kept = _history(path)
    whole = path.read_bytes()
    for rest in (b"", b"1.0,x,", b"\xff\xfe\n", whole):
        path.write_bytes(whole[: kept.length] + rest)
        with HistoryWriter(path, COLUMNS, kept=kept) as history:
            for k in (6, 7):
                history.append(row(k))
        assert path.read_bytes() == whole
    path.write_bytes(whole[: kept.length - 1])
    with pytest.raises(ValueError, match=f"must reach to .* that is have {kept.length} bytes"):
        HistoryWriter(path, COLUMNS, kept=kept)


@pytest.mark.parametrize("cell", ["x", "", "1.2.3", "1e", "--1", "\x00", "\ufffd", "0x10"])
@pytest.mark.parametrize("column", range(3))
def test_a_cell_that_is_no_number_is_named(tmp_path, cell, column):
    path = tmp_path / "history.csv"
    _history(path)
    lines = path.read_text().splitlines()
    cells = lines[4].split(",")
    cells[column] = cell
    lines[4] = ",".join(cells)
    path.write_text("\n".join(lines) + "\n")
    name, unit = COLUMNS[column]
    said = f"{path}, line 5, column '{name} [{unit}]': must be a number, got {cell!r}"
    with pytest.raises(ValueError, match=re.escape(said)):
        read_history(path)


def test_what_a_blown_up_run_writes_is_read(tmp_path):
    with HistoryWriter(tmp_path / "h.csv", COLUMNS) as history:
        history.append({"time": 0.0, "angle": np.nan, "torque": -np.inf})
    values, _ = read_history(tmp_path / "h.csv")
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
    path.write_text("\n".join([header, first, ",".join(cells)]) + "\n")
    with pytest.raises(ValueError, match=re.escape(f"{path}, line 3, column '{column}': {said}")):
        read_splits(path)
    path.write_text(f"{header}\n{first},1\n")
    with pytest.raises(ValueError, match=r"splits\.csv, line 2: must have 19 cells, got 20"):
        read_splits(path)
    for lines in ("", "a,b\n1,2\n"):
        path.write_text(lines)
        with pytest.raises(ValueError, match=r"splits\.csv, line 1: must name the columns"):
            read_splits(path)
