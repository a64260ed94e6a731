"""The progress display: its lines, its silence, and that it can neither stop nor slow a run."""

import io
import re

import pytest

from notched_strip import cutting
from shellcut.recording.resistance import resistance_of
from shellcut.recording.status_line import start_lines, status_line
from shellcut.view.progress import Progress

UNITS = {"angle": "deg", "torque": "N*mm", "imbalance": "%"}


class Terminal(io.StringIO):
    def isatty(self):
        return True


class Clock:
    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


def run(stream, clock, *, n=41, each=1.0, log=None):
    with Progress("opening", figure_units=UNITS, stream=stream, clock=clock, log=log) as shown:
        for k in range(n):
            shown.update(k / 95.0, step=1000 * k, angle=k, torque=143.6, imbalance=-0.04)
            clock.now += each


def test_elsewhere_than_on_a_terminal_there_are_about_ten_short_lines():
    stream, kept = io.StringIO(), []
    run(stream, Clock(), log=kept.append)
    lines = stream.getvalue().splitlines()
    assert lines[0] == "opening: 0 %: angle 0°, torque 143.6 N·mm"
    assert lines[1] == "opening: 10 %: angle 10°, torque 143.6 N·mm, 1 min 25 s left"
    assert len(lines) == 5  # at 0, 10, 20, 30 and 40 s, which is the last
    assert kept == [line.removeprefix("opening: ") for line in lines]
    for each in (1.0, 100.0):  # a fast run has lines every 10 s, a slow one every 10 %
        stream = io.StringIO()
        run(stream, Clock(), n=96, each=each)
        assert 9 <= len(stream.getvalue().splitlines()) <= 12


@pytest.mark.parametrize(
    ("columns", "text"),
    [
        (80, "40° 143.6 N·mm, 55 s left, imbalance -0.04 %"),
        (60, "40° 143.6 N·mm, 55 s left"),
        (40, ""),
    ],
)
def test_a_terminal_gets_a_bar_with_the_figures_it_has_room_for(monkeypatch, columns, text):
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", str(columns))
    stream = Terminal()
    run(stream, Clock())
    everything = stream.getvalue()
    last = next(line for line in reversed(everything.splitlines()) if "opening" in line)
    shown = re.sub(r"\x1b\[[\d;?]*[a-zA-Z]", "", last).rpartition("\r")[2]
    assert re.fullmatch(f"opening [━╺]+ +42 % *{re.escape(text)} *", shown)
    assert len(shown) <= columns
    monkeypatch.setenv("TERM", "dumb")  # it gets lines
    stream = Terminal()
    run(stream, Clock())
    assert "\x1b" not in stream.getvalue()
    assert "opening: 10 %: angle 10°, torque 143.6 N·mm, 1 min 25 s left" in stream.getvalue()


def test_an_odd_run_and_a_zero(monkeypatch):
    stream = io.StringIO()
    with Progress("opening", figure_units=UNITS, stream=stream) as shown:
        shown.update(0.0, step=0, torque=-0.0)
    assert "torque 0 N·mm" in stream.getvalue()
    monkeypatch.setattr("sys.stderr", None)
    for share in (0.5, float("nan"), float("inf"), -1.0, 2.0):
        for stream in (io.StringIO(), None):
            with Progress("opening", stream=stream) as shown:
                shown.update(share, step=1, torque=float("inf"))


@pytest.mark.parametrize("terminal", [False, True])
def test_a_closed_stream_does_not_stop_the_run(terminal, monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    stream = Terminal() if terminal else io.StringIO()
    shown = Progress("opening", stream=stream)
    stream.close()
    for k in range(3):
        shown.update(k, step=k)
    shown.close()


@pytest.mark.parametrize(
    ("left", "said"),
    [(7.4, "7 s"), (61.0, "1 min 01 s"), (3 * 3600 + 125, "3 h 02 min"), (0.1, "0 s")],
)
def test_the_time_that_is_left_is_told_in_two_units(left, said):
    stream, clock = io.StringIO(), Clock()
    with Progress("opening", stream=stream, clock=clock) as shown:
        shown.update(0.0, step=0)
        clock.now = 100.0
        shown.update(100.0 / (100.0 + left), step=10)
    assert f"%: {said} left" in stream.getvalue()


# --- the lines that tell of a run say its numbers


@pytest.fixture(scope="module")
def sim():
    sim = cutting()
    sim.run(4e-5)
    return sim


def test_the_status_line_agrees_with_the_ledger(sim):
    ledger, s = sim.ledger, sim.state
    # Bring entries to where each of them shows in four figures.
    ledger.cohesive_start_work = 3.0 * ledger.cohesive_work
    line = status_line(sim, resistance_of(sim, 8e-5), 0.5)
    told = line.replace(f"{s.n_cable} cables", "")
    numbers = {name: float(x) for name, x in re.findall(r"(\w+) ([-+]?[\d.]+(?:e[-+]\d+)?)", told)}
    assert line.startswith("50 %: path ")
    imbalance = 100.0 * ledger.relative(ledger.imbalance)
    assert abs(imbalance) > 1.0
    shown = {
        "path": sim.motion.coordinate(s.time),
        "energy": ledger.kinetic,
        "film": ledger.strain,
        "cables": 4.0 * ledger.cohesive_work,
        "tool": ledger.tool_work,
        "imbalance": imbalance,
        "crack": s.crack_length,
    }
    assert {name: numbers[name] for name in shown} == pytest.approx(shown, rel=1e-3)
    assert f", {s.n_cable} cables, {sim.cables.n_joint_made} met by the blade, " in line


def test_no_imbalance_is_said_before_there_is_work_to_compare_with():
    sim = cutting()
    assert sim.imbalance is None
    assert "imbalance" not in status_line(sim, resistance_of(sim, 8e-5), 0.0)
    sim.ledger.tool_work = 1e-6  # less than tears a tenth of a quad's side
    assert sim.imbalance is None
    sim.ledger.tool_work = 10.0
    assert sim.imbalance == sim.ledger.relative(sim.ledger.imbalance)
    assert "| imbalance 100 % |" in status_line(sim, resistance_of(sim, 8e-5), 0.0)


def test_a_start_says_film_tool_and_steps(sim):
    film, tool, cracks, motion, step = start_lines(sim, resistance_of(sim, 8e-5), 8e-5)
    assert f"{sim.mesh.n_quad} quads with sides of " in film
    assert "1 body" in tool
    assert cracks == 'cracks along sides of quads only (fracture.path = "edges")'
    assert re.fullmatch(
        r"motion to path \S+ mm in 0.08 ms; output: generalised force: work of the tool per mm of "
        r"the path of its edges; .*, which its supports move",
        motion,
    )
    assert f"about {round(8e-5 / sim.dt, -2):,.0f} steps, the first of {sim.dt:.4g} s" in step
    assert step.startswith("time   about ")
