"""The trials that the tables of cheats and of equal hands are made of are those that are played."""

import dataclasses

import pytest

from Testing.error_rates import played
from Testing.error_rates.equal_hands import HEADS, setup
from Testing.error_rates.played import SEEDS, SLOW, TASKS, USUAL, all_keys, play, stored


def assert_is_as_stored(key):
    """Other versions of the libraries may round otherwise, and hands meet the skin elsewhere."""
    kept = {one.key: one for one in stored()}[key]
    again = play(setup(key[0]), *key)
    assert again.measures.completion_time_s == pytest.approx(
        kept.measures.completion_time_s, rel=0.1
    )
    assert again.measures.tre_mm == pytest.approx(kept.measures.tre_mm, abs=0.4)
    assert again.measures.pressing_depth_mm == pytest.approx(
        kept.measures.pressing_depth_mm, abs=0.3
    )


@pytest.mark.parametrize("head", HEADS)
def test_the_usual_hands_play_a_task_of_each_head_as_they_did(head):
    assert_is_as_stored((head, USUAL, "task-1", SEEDS[USUAL][0]))


@pytest.mark.soak
@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("head", HEADS)
@pytest.mark.parametrize("way", [USUAL, SLOW])
def test_hands_play_every_task_of_every_head_as_they_did(way, head, task):
    for seed in SEEDS[way]:
        assert_is_as_stored((head, way, task, seed))


@pytest.mark.soak
@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("way", [way for way in SEEDS if way not in (USUAL, SLOW)])
def test_every_cheat_goes_as_it_went(way, task):
    for seed in SEEDS[way]:
        assert_is_as_stored(("colin27", way, task, seed))


def test_the_file_holds_every_trial_once_and_is_written_as_it_is_read(tmp_path, monkeypatch):
    trials = stored()
    assert [one.key for one in trials] == list(all_keys())
    before = played.FILE.read_bytes()
    monkeypatch.setattr(played, "FILE", tmp_path / "trials.csv")
    played.write([dataclasses.replace(one) for one in reversed(trials)])
    assert played.FILE.read_bytes() == before
