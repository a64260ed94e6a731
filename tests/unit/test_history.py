"""History files: exact numbers, whole lines whatever happens, units beside the names."""

import numpy as np
import pytest

from shellcut.results.history import HistoryWriter, read_history
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
    for until, first in ((None, 0), (None, 10), (np.inf, 20)):
        with HistoryWriter(path, COLUMNS, until=until) as history:
            for k in range(first, first + 10):
                history.append(row(k))
    np.testing.assert_array_equal(read_history(path)[0]["angle"], np.arange(10, 30) / 3.0)


def test_continuing_from_a_checkpoint_equals_the_uninterrupted_run(tmp_path):
    whole, broken = tmp_path / "whole.csv", tmp_path / "broken.csv"
    with HistoryWriter(whole, COLUMNS) as history:
        for k in range(20):
            history.append(row(k))
    with HistoryWriter(broken, COLUMNS) as history:
        for k in range(14):
            history.append(row(k))
    with broken.open("a") as file:  # the last line of a full disk
        file.write("1.4e-06,4.6")
    assert len(read_history(broken)[0]["time"]) == 14
    with HistoryWriter(broken, COLUMNS, until=row(9)["time"]) as history:
        for k in range(10, 20):
            history.append(row(k))
    assert whole.read_bytes() == broken.read_bytes()


def test_other_columns_and_foreign_files_are_refused(tmp_path):
    path = tmp_path / "history.csv"
    HistoryWriter(path, COLUMNS).close()
    with pytest.raises(ValueError, match=r"has other columns than this run: 'time \[s\]"):
        HistoryWriter(path, COLUMNS[:2], until=np.inf)
    path = tmp_path / "other.csv"
    path.write_text("a;b\n1;2\n")
    with pytest.raises(ValueError, match="is not a history file"):
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
    with HistoryWriter(path, [("time", "s"), ("torque", "N*mm")], until=np.inf) as writer:
        writer.append({"time": 0.25, "torque": 3.0})
    assert read_history(path)[0]["time"].tolist() == [0.0, 0.25]
