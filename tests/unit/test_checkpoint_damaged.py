"""A checkpoint that is not what was written is refused as such, whatever has befallen it."""

import hashlib
import re

import h5py
import numpy as np
import pytest

import shellcut.recording.checkpoint
from damaged.mutations import mutated
from notched_strip import cutting
from shellcut.recording.checkpoint import CheckpointError, load_checkpoint, save_checkpoint


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    path = tmp_path_factory.mktemp("saved") / "checkpoint.h5"
    sim = cutting()
    sim.run(2e-5)
    save_checkpoint(sim, path)
    return path


def test_whatever_the_damage_it_is_a_checkpoint_error(saved, tmp_path):
    sim, sound, rng = cutting(), saved.read_bytes(), np.random.default_rng(16)
    for _ in range(300):
        damaged, way = mutated(rng, sound, text=False)
        (tmp_path / "c.h5").write_bytes(damaged)
        with pytest.raises(CheckpointError):
            pytest.fail(f"{way}: {load_checkpoint(sim, tmp_path / 'c.h5')}")
    assert sim.state.step == 0


def as_if_written_so(path):
    """Make the digest of a checkpoint right again, as of one that another program wrote."""
    content = path.read_bytes()
    digest = hashlib.sha256(content[512:]).hexdigest()
    path.write_bytes(shellcut.recording.checkpoint._header(digest) + content[512:])


@pytest.mark.parametrize(
    "spoil",
    [
        lambda file, name: file.__delitem__(name),
        lambda file, name: replace_by(file, name, "text"),
        lambda file, name: replace_by(file, name, [[[1.5]]]),
        lambda file, name: replace_by(file, name, np.zeros(3, [("a", "f8"), ("b", "i4")])),
        lambda file, name: (file.__delitem__(name), file.create_group(name)),
    ],
    ids=["gone", "text", "more dimensions", "records", "group"],
)
def test_content_that_is_another_is_told_by_name(saved, tmp_path, spoil):
    # tables that are empty at the start take whatever rows there are
    names = [name for name, rows in leaves(cutting().saved(), "run") if np.size(rows)]
    for name in names[:: len(names) // 12]:
        path = tmp_path / "c.h5"
        path.write_bytes(saved.read_bytes())
        with h5py.File(path, "r+") as file:
            spoil(file, name)
        as_if_written_so(path)
        told = f"{re.escape(name.replace('/', '.'))}|cannot be loaded"
        with pytest.raises(CheckpointError, match=told):
            load_checkpoint(cutting(), path)


@pytest.mark.parametrize(
    ("name", "value"),
    [("inputs", "[1]"), ("inputs", "no JSON"), ("inputs", 3.0), ("run", 3.0), ("extra", 3.0)],
)
def test_forged_content_is_no_checkpoint(saved, tmp_path, name, value):
    path = tmp_path / "c.h5"
    path.write_bytes(saved.read_bytes())
    with h5py.File(path, "r+") as file:
        replace_by(file, name, value)
    as_if_written_so(path)
    with pytest.raises(CheckpointError, match=r"another program wrote it|another model"):
        load_checkpoint(cutting(), path)


def test_a_table_larger_than_its_file_is_not_read(saved, tmp_path):
    path = tmp_path / "c.h5"
    path.write_bytes(saved.read_bytes())
    with h5py.File(path, "r+") as file:
        file["extra"].create_dataset("huge", (10**13,), "f8", chunks=(10**6,), fillvalue=1.0)
    as_if_written_so(path)
    with pytest.raises(CheckpointError, match="has huge of"):
        load_checkpoint(cutting(), path)


def leaves(saved, prefix):
    for name, value in saved.items():
        if isinstance(value, dict):
            yield from leaves(value, f"{prefix}/{name}")
        else:
            yield f"{prefix}/{name}", value


def replace_by(file, name, value):
    del file[name]
    file[name] = value
