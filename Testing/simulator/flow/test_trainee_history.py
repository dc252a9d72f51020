"""The history and the scores of each trainee are read from the journals, among any other files."""

from __future__ import annotations

from rastrainer_simulator.flow.session.trainee_history import TraineeHistory
from Testing.domain.trial.trial_records import make_traced
from Testing.simulator.flow.scored_journals import (
    SCORES,
    TRAINEE,
    task_menu,
    write_aborted,
    write_journal,
    write_scored,
)

HEAD = "colin27"
ORDER = ("trial-run", "task-1", "task-2")


def test_the_trial_run_counts_once_all_points_were_touched_or_its_time_was_up(tmp_path):
    for trainee, entry, is_done in (
        ("P01", {"kind": "touch", "label": "1"}, False),
        ("P02", {"kind": "phase", "phase": "complete"}, True),
        ("P03", {"kind": "attempt", "record": {"reason": "trainee"}}, False),
        ("P04", {"kind": "attempt", "record": {"reason": "practice over"}}, True),
    ):
        write_journal(tmp_path, f"{trainee} 1", trainee, "trial-run", entry)
        write_journal(tmp_path, f"{trainee} 2", trainee, "task-2", entry)
        progress = TraineeHistory(tmp_path)
        assert progress.done[trainee, HEAD] == ({"trial-run"} if is_done else set())


def test_a_task_counts_once_registered(tmp_path):
    write_journal(tmp_path, "1", "P01", "trial-run", "registered")
    write_journal(tmp_path, "2", "P01", "task-1", "registered", "scored")
    write_journal(tmp_path, "3", "P01", "task-2", "aborted")
    write_journal(tmp_path, "4", "P02", "task-1", "registered")
    progress = TraineeHistory(tmp_path)
    assert [task in progress.done["P01", HEAD] for task in ORDER] == [True, True, False]
    assert progress.missing_before("P01", HEAD, "task-2", ORDER) is None
    # A trainee who has done a task skipped the trial run.
    assert progress.missing_before("P02", HEAD, "task-2", ORDER) is None
    assert progress.missing_before("P03", HEAD, "task-2", ORDER) == "trial-run"
    # Tasks done on one head do not count on another.
    assert progress.missing_before("P01", "other", "task-2", ORDER) == "trial-run"


def test_files_that_are_not_journals_or_were_altered_count_for_nothing(tmp_path):
    write_journal(tmp_path, "whole", "P01", "task-1", "registered")
    whole = (tmp_path / "whole.journal").read_bytes()
    (tmp_path / "forged.journal").write_bytes(whole.replace(b"P01", b"P02"))
    (tmp_path / "cut.journal").write_bytes(whole[:40])
    (tmp_path / "empty.journal").touch()
    (tmp_path / "noise.journal").write_bytes(bytes(range(256)) * 100)
    (tmp_path / "folder.journal").mkdir()
    write_journal(tmp_path, "odd", ["P03"], {"task": 1}, "registered")
    path = write_scored(tmp_path, 1, 41.25)
    path.write_bytes(path.read_bytes().replace(b"41.25", b"91.25"))
    progress = TraineeHistory(tmp_path)
    assert "task-1" in progress.done["P01", HEAD]
    assert "task-1" not in progress.done["P02", HEAD]
    assert progress.trend(TRAINEE, "desktop") == ()


def test_only_scores_of_the_same_mode_by_fiducials_are_compared(tmp_path):
    write_scored(tmp_path, 1, 40.0, 45.0)
    write_scored(tmp_path, 2, 99.0, task="trial-run")
    write_scored(tmp_path, 3, 98.0, make=make_traced)
    write_scored(tmp_path, 5, 60.0, mode="hmd")
    write_scored(tmp_path, 6)
    write_scored(tmp_path, 7, 55.0, task="task-2")
    write_aborted(tmp_path, 8)
    history = TraineeHistory(tmp_path)
    # The last score counts if a trial was scored again.
    assert history.trend(TRAINEE, "desktop") == (45.0, 55.0)
    assert history.trend(TRAINEE, "hmd") == (60.0,)
    assert history.trend("P08", "desktop") == ()


def test_the_best_acceptable_trials_of_a_task_come_first(tmp_path):
    second = write_scored(tmp_path, 1, 60.0)
    best = write_scored(tmp_path, 2, 50.0, 75.0, mode="hmd")
    write_scored(tmp_path, 3, 90.0, task="task-2")
    write_scored(tmp_path, 4, 95.0, make=make_traced)
    write_scored(tmp_path, 5, 80.0, is_safe=False)
    assert TraineeHistory(tmp_path).best(TRAINEE, "task-1") == (best, second)
    assert TraineeHistory(tmp_path).best("P08", "task-1") == ()


def test_a_trial_failed_by_aborting_counts_toward_competence_though_it_has_no_score(tmp_path):
    write_scored(tmp_path, 1, 40.0)
    write_aborted(tmp_path, 2)
    write_aborted(tmp_path, 3, touches=0)
    assert [trial.is_aborted for trial in TraineeHistory(tmp_path).own(TRAINEE)] == [False, True]


def test_a_new_trial_enters_the_trend_at_once_and_only_the_newest_are_shown(tmp_path):
    history = TraineeHistory(tmp_path)
    for number in range(1, 26):
        path = write_scored(tmp_path, number, float(number))
        history.changed(TRAINEE, path.stem.rpartition("_")[2])
    assert history.trend(TRAINEE, "desktop") == tuple(map(float, range(6, 26)))
    write_scored(tmp_path, 25, 25.0, 30.0)
    history.changed(TRAINEE, path.stem.rpartition("_")[2])
    assert history.trend(TRAINEE, "desktop")[-1] == 30.0


def test_the_task_menu_shows_the_trend_and_describes_it_in_words(loop, outside):
    menu = task_menu(loop, outside.services).menu
    assert (menu.trend.scores, menu.trend.mark) == (SCORES, 70.0)
    assert menu.paragraphs[0].endswith("the line is the pass mark, 70.")
    assert "38, 52, 47, 67, 71, 69, 88" in menu.trend.text
