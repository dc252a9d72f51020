"""How a trial was played follows from the entries of its journal."""

import pytest

from rastrainer.journal import entries
from rastrainer.protocol import Phase
from rastrainer.trial.how_played import HowPlayed, PlayRecording
from Testing.journal_lines import UTC, at, header, phase, sample


def timed(entry, sim_time_s, monotonic_s):
    return entries.Line(entries.Stamp(1, sim_time_s, monotonic_s, UTC), entry)


def played(*given) -> HowPlayed:
    """Return how a trial was played whose entries follow each other by a second."""
    recording = PlayRecording()
    for number, entry in enumerate(given):
        recording.add(entry if isinstance(entry, entries.Line) else at(float(number), entry))
    return recording.played()


def session(speed=1.0, is_seeded=False):
    return header(session=entries.PlayingSession(speed, is_seeded))


def continued(speed=1.0, phase=Phase.PAUSED):
    return entries.Continued(
        since_s=0.0,
        session=entries.PlayingSession(speed, False),
        camera="far",
        phase=phase,
        kept=0,
        next_point=None,
        versions={},
    )


def moved(x_mm, moved_by):
    return sample((x_mm, 0.0, 0.0), moved_by=moved_by)


def start(seed=None):
    return entries.CommandDone("StartTask", {"seed": seed}, "anna")


REACH = entries.Reach(False, "")


def test_the_way_is_shared_among_what_moved_the_tip():
    ways = (moved(0, "sticks"), moved(6, "sticks"), moved(8, "commands"), moved(8, ""))
    found = played(session(), start(), *ways)
    assert found.way_mm == {"sticks": 6.0, "commands": 2.0}
    assert found.commanded_share == pytest.approx(0.25)
    assert (found.started_by, found.seed_source) == ("anna", "drawn")
    assert "25 % of the way" in found.objections("desktop", ())[0]


def test_another_speed_after_an_interruption_is_not_hidden_by_the_first():
    found = played(session(), start(), continued(speed=0.5))
    assert found.speed == 0.5
    assert found.objections("desktop", ()) != ()


def test_a_simulator_that_is_held_up_is_slow_by_the_clock():
    found = played(session(), start(), timed(REACH, 2.0, 4.0))
    assert (found.speed, found.pace) == (1.0, 0.5)
    # The time until a trial is resumed is no part of it.
    assert played(session(), timed(continued(), 1.0, 900.0)).pace == 1.0


@pytest.mark.parametrize(
    ("waits", "then", "pace"),
    [
        (Phase.PAUSED, Phase.RUNNING, 0.5),
        (Phase.COMPLETE, Phase.VERIFYING, 0.5),
        # The trial's time has run on: more points follow.
        (Phase.COMPLETE, Phase.RUNNING, 902.0 / 904.0),
    ],
)
def test_a_long_wait_does_not_hide_that_the_simulator_was_held_up(waits, then, pace):
    held_up, over = timed(REACH, 2.0, 4.0), timed(phase(then), 902.0, 904.0)
    for wait in (phase(waits), continued(phase=waits)):
        assert played(session(), start(), held_up, timed(wait, 2.0, 4.0), over).pace == pace
