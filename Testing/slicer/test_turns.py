"""Steps of the main thread: one in a turn, or all at once where somebody waits for the end."""

import pytest

from rastrainer.slicer.turns import Turns


@pytest.fixture
def loop():
    """The functions that are to be called in later turns."""
    return []


def steps(done, error=None):
    for number in range(3):
        done.append(number)
        yield
    if error is not None:
        raise error


def test_each_turn_does_one_step_and_whoever_waits_has_the_rest_done_at_once(loop):
    done = []
    turns = Turns(steps(done), loop.append)
    loop.pop()()
    assert (done, turns.isOver) == ([0], False)
    turns.finish()
    assert (done, turns.isOver) == ([0, 1, 2], True)
    loop.pop()()
    assert loop == []


def test_what_is_stopped_or_has_failed_does_nothing_more(loop):
    done = []
    turns = Turns(steps(done), loop.append)
    turns.isOver = True
    loop.pop()()
    assert (done, loop) == ([], [])
    turns = Turns(steps(done, ValueError("broken")), loop.append)
    with pytest.raises(ValueError, match="broken"):
        turns.finish()
    turns.finish()
    assert (done, turns.isOver) == ([0, 1, 2], True)
