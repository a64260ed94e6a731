"""HDF5 on a disk that fills up: the frames before are there, and the process lives on."""

import subprocess
import sys
from contextlib import closing, nullcontext
from pathlib import Path

import h5py
import numpy as np
import pytest

from opening_frame import opening_frame
from shellcut.files import hdf_target
from shellcut.files.hdf_target import HdfTarget
from shellcut.results.vtkhdf import VtkHdfWriter
from shellcut.results.vtkhdf_reader import VtkHdfReader
from small_disk import REFUSAL, files_of_at_most


def frames(n):
    return [opening_frame(2.0 * k, n_side=4, time=1e-4 * (k + 1)) for k in range(n)]


def append_all(writer, wanted):
    for frame in wanted:
        writer.append(frame)


def fill(path, wanted):
    """Write frames until the system refuses; return how many went in."""
    with closing(VtkHdfWriter(path)) as writer:
        with pytest.raises(OSError, match=REFUSAL) as refusal:
            append_all(writer, wanted)
        assert str(path) in str(refusal.value)
        n = writer.n_frame
        with pytest.raises(OSError, match=REFUSAL):
            writer.append(wanted[-1])
        assert writer.n_frame == n
        return n


def assert_goes_on(path, wanted, n):
    reader = VtkHdfReader(path)
    assert reader.times.tolist() == [frame.time for frame in wanted[:n]]
    for k in range(n):
        np.testing.assert_array_equal(reader.frame(k).quads, wanted[k].quads)
    with closing(VtkHdfWriter(path, until=wanted[n - 1].time if n else -np.inf)) as writer:
        assert writer.n_frame == n
        writer.append(wanted[n])
    np.testing.assert_array_equal(VtkHdfReader(path).frame(n).quads, wanted[n].quads)


def fill_up_to_many_sizes(folder):
    """Run in a process of its own, which HDF5 would end."""
    wanted = frames(12)
    counts = []
    for size in range(40_000, 290_000, 48_000):
        path = Path(folder) / f"{size}.vtkhdf"
        with files_of_at_most(size):
            n = fill(path, wanted)
        assert_goes_on(path, wanted, n)
        counts.append(n)
    assert counts == sorted(counts)
    assert counts[0] == 0
    assert counts[-1] > 5


def test_whatever_the_size_the_frames_before_are_there(tmp_path):
    pytest.importorskip("resource", reason="needs limits on the size of files")
    here = Path(__file__).parent
    script = f"import sys; sys.path[:0] = [{str(here)!r}, {str(here.parent)!r}]\n"
    script += "from test_hdf_target import fill_up_to_many_sizes\n"
    script += f"fill_up_to_many_sizes({str(tmp_path)!r})"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_a_file_that_fails_is_what_it_was_and_hdf5_finds_its_own(tmp_path):
    path, rows = tmp_path / "a.h5", np.arange(30_000.0)
    target = HdfTarget(path, "w")
    with h5py.File(target, "w") as file:
        file["first"] = rows[:100]
        file.flush()
        target.keep()
        good = path.read_bytes()
        with files_of_at_most(len(good) + 50_000):
            file["first"][:] = -1.0
            file["second"] = rows
            file.flush()
            with pytest.raises(OSError, match=REFUSAL):
                target.keep()
        assert path.read_bytes() == good
        np.testing.assert_array_equal(file["second"], rows)
        assert (file["first"][:] == -1.0).all()
        # What comes later, with room again, is not on the disk either: it would not fit.
        file["third"] = rows[:10]
        file.flush()
        with pytest.raises(OSError, match=REFUSAL):
            target.keep()
    target.close()
    with h5py.File(path, "r") as file:
        assert list(file) == ["first"]
        np.testing.assert_array_equal(file["first"], rows[:100])


def test_who_closes_is_told_what_nobody_was_told(tmp_path):
    target = HdfTarget(tmp_path / "a.h5", "w")
    with h5py.File(target, "w") as file:
        file["a"] = np.arange(1000.0)
    with files_of_at_most(1000), pytest.raises(OSError, match=REFUSAL):
        target.close()
    target.close()


class Killed(BaseException):
    pass


@pytest.mark.parametrize("n_write", range(6))
def test_what_a_killed_process_has_overwritten_is_put_back(tmp_path, monkeypatch, n_write):
    path, write, left = tmp_path / "f.h5", hdf_target.write_all, n_write

    def killed(file, data):
        nonlocal left
        write(file, data if left else data[: len(data) // 2])
        left -= 1
        if left < 0:
            raise Killed

    target = HdfTarget(path, "w")
    target.write(b"consistent")
    target.keep()
    for at, data in ((3, b"___"), (8, b"___and more"), (4, b"!!")):
        target.seek(at)
        target.write(data)
    assert path.read_bytes() == b"consistent"
    target.seek(0)
    now = target.read()
    assert now == b"con_!!te___and more"
    with monkeypatch.context() as patch:
        patch.setattr(hdf_target, "write_all", killed)
        # Of the note, and of each of the three pieces, one of which is in two parts.
        with pytest.raises(Killed) if n_write < 5 else nullcontext():
            target.keep()
    for mode in ("r", "r+", "r"):
        with closing(HdfTarget(path, mode)) as again:
            assert again.read() == (b"consistent" if n_write < 5 else now)
    assert [p.name for p in tmp_path.iterdir()] == ["f.h5"]


def test_a_file_that_gets_shorter_gets_its_end_back(tmp_path, monkeypatch):
    path = tmp_path / "f.h5"
    with closing(HdfTarget(path, "w")) as target:
        target.write(b"consistent")
        target.keep()
        target.truncate(4)
        assert path.read_bytes() == b"consistent"
        with monkeypatch.context() as patch:
            patch.setattr(hdf_target.HdfTarget, "_put", lambda target, *_: target._file.truncate(4))
            patch.setattr(hdf_target.Path, "unlink", lambda *_, **__: None)
            target.keep()
        with closing(HdfTarget(path, "r")) as reader:
            assert reader.read() == b"consistent"
