"""The command: exit codes, and a warm-up in a process of its own."""

import subprocess
import sys

import pytest

from shellcut.command_line import main


def test_warmup_says_where_the_cache_is(capsys):
    assert main(["warmup"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("compiling the kernels")
    assert "done in" in said


@pytest.mark.parametrize("wrong", [[], ["wramup"]])
def test_bad_arguments_leave_with_two(wrong):
    with pytest.raises(SystemExit) as left:
        main(wrong)
    assert left.value.code == 2


def test_the_module_is_the_command():
    done = subprocess.run(
        [sys.executable, "-m", "shellcut", "--help"], check=True, capture_output=True, text=True
    )
    assert "warmup" in done.stdout
