"""Numbers that nobody means: every one of them is refused in words, or makes a model that steps.

A small part of all, seeded.
"""

import re
import sys

import pytest

import model_numbers
from shellcut import ModelFileError, read_model
from shellcut.command_line import main
from shellcut.model_file.reader import model_of_text

SAMPLE = model_numbers.sample(90, ("strip", "sheet", "disc"))


@pytest.mark.parametrize("what", [what for what, _ in SAMPLE])
def test_a_number_is_refused_or_built(what):
    assert model_numbers.outcome(dict(SAMPLE)[what]) in ("refused", "built", "blew up")


STRIP = 'model = "guillotine"\n[membrane]\nlength = 6.0\nwidth = 4.0\nsize = 1.0\nnotch = 1.0\n'


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[damping]\nbeta = 1e3", r"damping_beta must damp the stiffest quad 10,000 times critic"),
        ("[time]\nfixed = 1e-17", r"must take 1e\+11 steps at most, .* time.fixed is 1e-17 s"),
        (
            "[material]\ndensity = 1e-30",
            r":9: \[material\].density must be a number in t/mm\^3, 0 or",
        ),
        (
            "[material]\nthickness = '1e400 mm'",
            r":9: .*that a computer's number can hold, up to 1.8",
        ),
        ("[material]\nthickness = '1e999999999 mm'", "that a computer's number can hold"),
        ("[material]\nthickness = '1 mm^999999999'", "a unit to a power of 9 at most"),
        ("[motion]\ntravel = 1e300", r":9: .*0 or from 1e-18 to 1e\+18 in magnitude, got 1e\+300"),
        ("[tool]\nfile = '~no-such-user/cap.stl'", "must name a file, got '~no-such-user/cap.stl'"),
        ("[tool]\nfile = 'a\\u0000b'", "must name a file, got 'a"),
        (
            "[output]\nrows = 99999999999999",
            r"\[output\].rows must be a whole number up to 1,000,00",
        ),
        (f"[output]\nrows = {10**400}", "must hold whole numbers up to 9223372036854775807"),
        (f"[output]\nrows = 1{'0' * 5000}", r"is not a model file \(TOML\): Exceeds the limit"),
        (f"x = {'[' * 3000}{']' * 3000}", "must nest tables and arrays to 8 lev"),
        (f"x.{'y.' * 20}z = 1", "must nest tables and arrays to 8 levels"),
        (f"x.{'y.' * 1_000}z = 1", "a key must have 100 parts at most, got 1,002"),
        (f"[x{'.y' * 1_000}]", "a key must have 100 parts at most, got 1,001"),
    ],
    ids=lambda text: text[:24],
)
def test_what_cannot_be_is_told_in_words(tmp_path, text, told):
    if "'a\\u0000b'" in text:
        text = text.replace("'", '"')
    path = tmp_path / "model.toml"
    path.write_text(f"{STRIP}\n{text}\n")
    with pytest.raises(ModelFileError, match=re.compile(told, re.DOTALL)):
        read_model(path).build()


@pytest.mark.parametrize(
    "text",
    [
        f"[x{'.y' * 50_000}]",
        f"x = {[0.1] * 50_000}",
        'name = """' + "\n".join("a" * 50_000) + '"""',
        "[material]\nname = [\n" + "1,\n" * 50_000,
    ],
    ids=["heading", "array", "text", "unclosed"],
)
def test_a_message_about_something_long_is_short_and_comes_at_once(text):
    with pytest.raises(ModelFileError) as told:
        model_of_text(f"{STRIP}\n{text}\n", "model.toml")
    assert len(str(told.value)) < 2_000


def test_sizes_are_refused_before_the_work(tmp_path, capsys):
    path = tmp_path / "model.toml"
    path.write_text(STRIP)
    for setting in ("membrane.width=6e9", "membrane.size=1e-6", "threads=100000"):
        argv = ["run", str(path), "--set", setting, "-o", str(tmp_path / "out")]
        assert main(argv) == 2
        told = capsys.readouterr().err
        assert f"set {setting.split('=')[0]}=" in told or "[membrane]" in told or "threads" in told
        assert "Traceback" not in told
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("value", [10**5000, [[[[[[[[[[1]]]]]]]]]]], ids=["long", "deep"])
def test_overrides_of_a_script_are_refused_too(value):
    with pytest.raises(ModelFileError, match=r"set tool\.radius: the value must (hold|nest)"):
        read_model("opening", {"tool.radius": value})


def test_more_memory_than_there_is_is_told(monkeypatch, capsys):
    def build(_):
        raise MemoryError("Unable to allocate 112. GiB")

    monkeypatch.setattr(sys.modules["shellcut.model_file.model"].Model, "build", build)
    assert main(["preview", "opening"]) == 2
    assert "does not have enough memory: Unable to allocate 112. GiB" in capsys.readouterr().err
