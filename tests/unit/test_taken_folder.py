"""What makes room for another run is what a run has written, and nothing else."""

import pytest

from shellcut.files.file_list import FILES, OTHERS, FileList, claim, files_there, names_in, target
from shellcut.files.taken_folder import TakenFolder


@pytest.fixture
def taken(tmp_path):
    folder = TakenFolder(tmp_path / "out")
    yield folder
    folder.lock.close()


def fill(folder, *names):
    for name in names:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(name)


def left(folder):
    return sorted(p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file())


def run_before(folder, *names):
    """Leave what a run does, and give the folder back."""
    taken = TakenFolder(folder)
    taken.begin(names, replace=True)
    fill(folder, *names)
    taken.lock.close()


def test_what_a_run_wrote_goes_and_all_else_stays(tmp_path):
    out = tmp_path / "out"
    run_before(out, "history.csv", "energy.png", "a_frames/frame_0000.vtu", "checkpoint.h5")
    # Of one killed while it wrote its checkpoint.
    fill(out, f"checkpoint.part-{'0a' * 8}.h5")
    mine = ["force_measured.png", "mine.vtkhdf", "snapshot_of_my_part.png", "snapshot_07.png"]
    mine += ["b_frames/frame_0000.vtu", "notes/history.csv"]
    mine += ["checkpoint.part.h5"]
    fill(out, *mine)
    taken = TakenFolder(out)
    taken.begin(["history.csv"], replace=True)
    taken.lock.close()
    assert left(out) == sorted([*mine, FILES])
    assert not (out / "a_frames").exists()
    assert names_in(out) == ["history.csv"]


def test_a_folder_of_frames_with_something_else_in_it_stays(tmp_path):
    out = tmp_path / "out"
    run_before(out, "a_frames/frame_0000.vtu")
    fill(out, "a_frames/mine.vtu")
    taken = TakenFolder(out)
    taken.begin([], replace=True)
    taken.lock.close()
    assert left(out) == ["a_frames/mine.vtu", FILES]


def test_a_run_is_not_replaced_unasked(tmp_path):
    out = tmp_path / "out"
    run_before(out, "history.csv", "energy.png")
    before = left(out)
    taken = TakenFolder(out)
    with pytest.raises(FileExistsError, match=r"already holds a run, with history\.csv"):
        taken.begin(["history.csv"], replace=False)
    taken.lock.close()
    assert left(out) == before


@pytest.mark.parametrize("replace", [False, True])
def test_what_no_run_wrote_is_not_replaced_either(tmp_path, replace):
    out = tmp_path / "out"
    out.mkdir()
    fill(out, "history.csv", "snapshot_01.png", "notes.txt")
    taken = TakenFolder(out)
    wanted = (
        r"has history\.csv, snapshot_01\.png, which this run would replace although no run wrote it"
    )
    with pytest.raises(FileExistsError, match=wanted):
        taken.begin(["history.csv"], ["snapshot_00.png", "snapshot_01.png"], replace=replace)
    taken.lock.close()
    assert left(out) == ["history.csv", "notes.txt", "snapshot_01.png"]


def test_a_list_of_another_origin_is_no_list(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    fill(out, "precious.txt")
    (out / FILES).write_text("precious.txt\n")
    taken = TakenFolder(out)
    with pytest.raises(FileExistsError, match=FILES):
        taken.begin(["history.csv"], replace=True)
    taken.lock.close()
    assert left(out) == ["precious.txt", FILES]


def test_a_list_leads_to_nothing_outside(tmp_path):
    out = tmp_path / "out"
    fill(tmp_path, "precious.txt")
    run_before(out, "history.csv")
    heading = (out / FILES).read_text().split("\n")[0]
    wrong = ["../precious.txt", str(tmp_path / "precious.txt"), "a/../../precious.txt", "", "."]
    wrong += ["C:\\precious.txt", "\\\\host\\precious.txt"]
    (out / FILES).write_text("\n".join([heading, *wrong, "history.csv", "precious.t"]))
    # The last line was not finished: what it names is not known.
    assert names_in(out) == ["history.csv"]
    taken = TakenFolder(out)
    taken.begin([], replace=True)
    taken.lock.close()
    assert (tmp_path / "precious.txt").exists()


def test_names_are_listed_before_their_files_are_there(taken):
    taken.begin(["history.csv"], replace=True)
    assert names_in(taken.path) == ["history.csv"]
    taken.files.add("a_frames/frame_0000.vtu")
    taken.files.add("history.csv")
    assert names_in(taken.path) == ["history.csv", "a_frames/frame_0000.vtu"]
    assert files_there(taken.path) == []
    fill(taken.path, "history.csv")
    assert files_there(taken.path) == ["history.csv"]
    taken.clear()
    assert left(taken.path) == ["run.lock"]


def test_a_run_gone_on_with_keeps_its_list(tmp_path):
    out = tmp_path / "out"
    run_before(out, "history.csv", "snapshot_00.png")
    taken = TakenFolder(out)
    taken.resume(["history.csv", "summary.json"])
    assert taken.files.names == ["history.csv", "snapshot_00.png", "summary.json"]
    fill(out, "summary.json", "mine.png")
    taken.files.remove(["summary.json", "mine.png"])
    taken.lock.close()
    assert left(out) == sorted(["history.csv", FILES, "snapshot_00.png", "mine.png"])
    assert FileList(out).there() == ["history.csv", "snapshot_00.png"]


def test_links_in_a_folder_lead_to_nothing_that_a_run_may_touch(tmp_path):
    out, mine = tmp_path / "out", tmp_path / "mine"
    mine.mkdir()
    fill(mine, "frame_0000.vtu", "history.csv")
    run_before(out, "history.csv", "a_frames/frame_0000.vtu")
    (out / "history.csv").unlink()
    (out / "history.csv").symlink_to(mine / "history.csv")
    (out / "a_frames" / "frame_0000.vtu").unlink()
    (out / "a_frames").rmdir()
    (out / "a_frames").symlink_to(mine)
    taken = TakenFolder(out)
    with pytest.raises(FileExistsError, match=r"has a_frames/frame_0000\.vtu"):
        taken.begin(["history.csv"], ["a_frames/frame_0000.vtu"], replace=True)
    taken.begin(["history.csv"], replace=True)  # removes the link, not what it leads to
    assert not (out / "history.csv").is_symlink()
    with pytest.raises(FileExistsError):
        taken.files.add("a_frames/frame_0000.vtu")
    taken.lock.close()
    assert left(mine) == ["frame_0000.vtu", "history.csv"]


def test_a_list_behind_a_link_is_somebody_elses(tmp_path):
    run_before(tmp_path / "other", "history.csv")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / FILES).symlink_to(tmp_path / "other" / FILES)
    fill(tmp_path / "out", "history.csv")
    assert names_in(tmp_path / "out") == []
    taken = TakenFolder(tmp_path / "out")
    with pytest.raises(FileExistsError, match=FILES):
        taken.begin(["history.csv"], replace=True)
    taken.lock.close()
    assert names_in(tmp_path / "other") == ["history.csv"]


def test_a_command_replaces_what_commands_wrote_and_no_input(tmp_path):
    run_before(tmp_path, "history.csv")
    claim(tmp_path, ["a.csv", "b.csv"])
    fill(tmp_path, "a.csv", "mine.csv")
    claim(tmp_path, ["b.csv", "a.csv"])
    assert names_in(tmp_path, OTHERS) == ["a.csv", "b.csv"]
    for name in ("mine.csv", "history.csv", "run.lock", FILES):
        with pytest.raises(FileExistsError, match=name):
            claim(tmp_path, ["c.csv", name])
    with pytest.raises(FileExistsError, match=r"a\.csv is read here"):
        claim(tmp_path, ["a.csv"], [tmp_path / "nothing", tmp_path / "." / "a.csv"])
    assert names_in(tmp_path, OTHERS) == ["a.csv", "b.csv"]
    # What a user names is replaced, but no input and nothing of a run.
    assert target(tmp_path / "mine.csv", tmp_path / "c.csv") == tmp_path / "mine.csv"
    for name in ("a.csv", "history.csv", "run.lock", FILES, OTHERS):
        with pytest.raises(FileExistsError, match=name):
            target(tmp_path / name, tmp_path / "c.csv", [tmp_path / "a.csv"])
    with pytest.raises(ValueError, match="must have a name"):
        claim("", ["a.csv"])
    with pytest.raises(ValueError, match="must have a name"):
        TakenFolder("")
