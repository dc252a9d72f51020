"""How a trial was played follows from the entries of its journal."""

from dataclasses import replace

import pytest

from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.trial.how_played import HowPlayed, PlayRecording


def played(*entries) -> HowPlayed:
    """Return how a trial was played whose entries follow each other by a second."""
    recording = PlayRecording()
    for number, entry in enumerate(entries):
        recording.add({"simTimeS": float(number), "monotonicS": float(number), **entry})
    return recording.played()


def session(kind="header", speed=1.0, is_seeded=False):
    of_session = {"session": {"speed": speed, "isSeeded": is_seeded}}
    return {"kind": kind, **({"phase": "paused"} if kind == "continued" else {}), **of_session}


def sample(x_mm, moved_by):
    return {"kind": "sample", "tipMm": [x_mm, 0.0, 0.0], "movedBy": moved_by}


def start(seed=None):
    return {"kind": "command", "name": "StartTask", "sender": "anna", "arguments": {"seed": seed}}


def test_the_way_is_shared_among_what_moved_the_tip():
    ways = (sample(0, "sticks"), sample(6, "sticks"), sample(8, "commands"), sample(8, ""))
    found = played(session(), start(), *ways)
    assert found.way_mm == {"sticks": 6.0, "commands": 2.0}
    assert found.commanded_share == pytest.approx(0.25)
    assert (found.started_by, found.seed_source) == ("anna", "drawn")
    assert "25 % of the way" in found.objections("desktop", ())[0]


def test_a_seed_is_chosen_by_a_client_or_for_the_session():
    assert played(session(is_seeded=True), start()).seed_source == "session"
    assert played(session(is_seeded=True), start(seed=3)).seed_source == "client"


def test_another_speed_after_an_interruption_is_not_hidden_by_the_first():
    found = played(session(), start(), session("continued", speed=0.5))
    assert found.speed == 0.5
    assert found.objections("desktop", ()) != ()


def test_a_simulator_that_is_held_up_is_slow_by_the_clock():
    held_up = {"kind": "reach", "simTimeS": 2.0, "monotonicS": 4.0}
    found = played(session(), start(), held_up)
    assert (found.speed, found.pace) == (1.0, 0.5)
    # The time until a trial is resumed is no part of it.
    assert played(session(), session("continued") | {"monotonicS": 900.0}).pace == 1.0


@pytest.mark.parametrize(
    ("waits", "then", "pace"),
    [
        ("paused", "running", 0.5),
        ("complete", "verifying", 0.5),
        # The trial's time has run on: more points follow.
        ("complete", "running", 902.0 / 904.0),
    ],
)
def test_a_long_wait_does_not_hide_that_the_simulator_was_held_up(waits, then, pace):
    late = {"simTimeS": 2.0, "monotonicS": 4.0}
    held_up, wait = {"kind": "reach", **late}, {"kind": "phase", "phase": waits, **late}
    over = {"kind": "phase", "phase": then, "simTimeS": 902.0, "monotonicS": 904.0}
    assert played(session(), start(), held_up, wait, over).pace == pace
    continued = session("continued") | {"phase": waits, **late}
    assert played(session(), start(), held_up, continued, over).pace == pace


def test_pauses_and_views_are_counted():
    views = [{"kind": "display", "view": name} for name in ("desktop", "headset", "headset")]
    pause = {"kind": "phase", "phase": "paused"}
    found = played(session(), pause, {"kind": "phase", "phase": "running"}, pause, *views)
    assert (found.pauses, found.view_s) == (2, {"desktop": 1, "headset": 2})


def test_it_is_read_as_it_was_written_and_invalid_values_are_refused():
    found = played(session(speed=None), start(seed=1), sample(0, ""), sample(1, "alignment"))
    assert record_from_json(HowPlayed, record_to_json(found)) == found
    with pytest.raises(InputError, match="seedSource"):
        record_from_json(HowPlayed, record_to_json(replace(found, seed_source="dice")))
