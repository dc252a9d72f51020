"""The task menu shows the trainee's own scores, of the journals, by trial."""

from __future__ import annotations

import pytest

from rastrainer_simulator.flow.session.trainee_history import TraineeHistory
from Testing.domain.trial.trial_records import make_traced
from Testing.simulator.flow.scored_journals import (
    SCORES,
    TRAINEE,
    task_menu,
    write_aborted,
    write_scored,
)


@pytest.fixture
def history_of(tmp_path):
    """Return what reads a folder's history as a session does."""
    return lambda: TraineeHistory(tmp_path)


def test_only_scores_of_the_same_mode_by_fiducials_are_compared(tmp_path, history_of):
    write_scored(tmp_path, 1, 40.0, 45.0)
    write_scored(tmp_path, 2, 99.0, task="trial-run")
    write_scored(tmp_path, 3, 98.0, make=make_traced)
    write_scored(tmp_path, 5, 60.0, mode="hmd")
    write_scored(tmp_path, 6)
    write_scored(tmp_path, 7, 55.0, task="task-2")
    write_aborted(tmp_path, 8)
    history = history_of()
    # The last score counts if a trial was scored again.
    assert history.trend(TRAINEE, "desktop") == (45.0, 55.0)
    assert history.trend(TRAINEE, "hmd") == (60.0,)
    assert history.trend("P08", "desktop") == ()


def test_the_best_acceptable_trials_of_a_task_come_first(tmp_path, history_of):
    second = write_scored(tmp_path, 1, 60.0)
    best = write_scored(tmp_path, 2, 50.0, 75.0, mode="hmd")
    write_scored(tmp_path, 3, 90.0, task="task-2")
    write_scored(tmp_path, 4, 95.0, make=make_traced)
    write_scored(tmp_path, 5, 80.0, is_safe=False)
    assert history_of().best(TRAINEE, "task-1") == (best, second)
    assert history_of().best("P08", "task-1") == ()


def test_a_trial_failed_by_aborting_counts_toward_competence_though_it_has_no_score(
    tmp_path, history_of
):
    write_scored(tmp_path, 1, 40.0)
    write_aborted(tmp_path, 2)
    write_aborted(tmp_path, 3, touches=0)
    assert [trial.is_aborted for trial in history_of().of(TRAINEE)] == [False, True]


def test_a_score_whose_journal_was_altered_is_left_out(tmp_path, history_of):
    path = write_scored(tmp_path, 1, 41.25)
    write_scored(tmp_path, 2, 50.0)
    path.write_bytes(path.read_bytes().replace(b"41.25", b"91.25"))
    assert history_of().trend(TRAINEE, "desktop") == (50.0,)


def test_a_new_trial_enters_the_trend_at_once_and_only_the_newest_are_shown(tmp_path, history_of):
    history = history_of()
    for number in range(1, 26):
        path = write_scored(tmp_path, number, float(number))
        history.changed(TRAINEE, path.stem.rpartition("_")[2])
    assert history.trend(TRAINEE, "desktop") == tuple(map(float, range(6, 26)))
    write_scored(tmp_path, 25, 25.0, 30.0)
    history.changed(TRAINEE, path.stem.rpartition("_")[2])
    assert history.trend(TRAINEE, "desktop")[-1] == 30.0


@pytest.mark.parametrize(
    ("language", "sentence"),
    [("en", "the line is the pass mark, 70."), ("de", "die Linie ist die Marke zum Bestehen, 70.")],
)
def test_the_task_menu_shows_the_trend_and_describes_it_in_words(loop, outside, language, sentence):
    menu = task_menu(loop, outside.services, language=language).menu
    assert (menu.trend.scores, menu.trend.mark) == (SCORES, 70.0)
    assert menu.paragraphs[0].endswith(sentence)
    assert "38, 52, 47, 67, 71, 69, 88" in menu.trend.text
