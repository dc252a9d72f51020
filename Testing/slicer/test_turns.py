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


def test_each_turn_does_one_step(loop):
    done, counts = [], []
    turns = Turns(steps(done), loop.append)
    while loop:
        counts.append(len(done))
        loop.pop()()
    assert (counts[:4], turns.isOver) == ([0, 1, 2, 3], True)


def test_whoever_waits_has_the_rest_done_at_once_and_no_turn_does_it_again(loop):
    done = []
    turns = Turns(steps(done), loop.append)
    loop.pop()()
    turns.finish()
    assert (done, turns.isOver) == ([0, 1, 2], True)
    loop.pop()()
    assert loop == []


def test_a_step_that_asks_for_the_end_is_not_entered_again(loop):
    def asking():
        turns.finish()
        yield
        turns.finish()

    turns = Turns(asking(), loop.append)
    turns.finish()
    assert turns.isOver


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
