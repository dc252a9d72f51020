"""The history of each trainee is read from the journals, among any other files."""

from __future__ import annotations

import pytest

from rastrainer.journal.journal_file import NO_LINE, encode_line
from rastrainer_simulator.flow.session.trainee_history import TraineeHistory

HEAD = "colin27"
ORDER = ("trial-run", "task-1", "task-2")


def write_journal(folder, name, trainee, task, *kinds, scenario=HEAD):
    lines, previous = [], NO_LINE
    head = {"name": scenario}
    entries = [{"kind": "header", "trainee": trainee, "scenario": head, "task": task}]
    entries += [{"kind": kind} if isinstance(kind, str) else kind for kind in kinds]
    for number, entry in enumerate(entries, 1):
        line, previous = encode_line(number, previous, entry)
        lines.append(line)
    (folder / f"{name}.journal").write_bytes(b"".join(lines))


@pytest.mark.parametrize(
    ("entry", "is_done"),
    [
        ({"kind": "touch", "label": "1"}, False),
        ({"kind": "phase", "phase": "complete"}, True),
        ({"kind": "attempt", "record": {"reason": "trainee"}}, False),
        ({"kind": "attempt", "record": {"reason": "practice over"}}, True),
    ],
)
def test_the_trial_run_counts_once_all_points_were_touched_or_its_time_was_up(
    tmp_path, entry, is_done
):
    write_journal(tmp_path, "1", "P01", "trial-run", entry)
    write_journal(tmp_path, "2", "P01", "task-2", entry)
    progress = TraineeHistory(tmp_path)
    assert ("trial-run" in progress.done["P01", HEAD]) is is_done
    assert "task-2" not in progress.done["P01", HEAD]


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
    assert progress.missing_before("nobody", HEAD, "trial-run", ORDER) is None


def test_a_task_on_one_head_does_not_count_for_another(tmp_path):
    write_journal(tmp_path, "1", "P01", "trial-run", "registered", scenario="other")
    progress = TraineeHistory(tmp_path)
    progress.done["P01", "other"].add("task-1")
    assert progress.missing_before("P01", "other", "task-2", ORDER) is None
    assert progress.missing_before("P01", HEAD, "task-2", ORDER) == "trial-run"


def test_files_that_are_not_journals_count_for_nothing(tmp_path):
    write_journal(tmp_path, "whole", "P01", "task-1", "registered")
    whole = (tmp_path / "whole.journal").read_bytes()
    (tmp_path / "forged.journal").write_bytes(whole.replace(b"P01", b"P02"))
    (tmp_path / "cut.journal").write_bytes(whole[:40])
    (tmp_path / "empty.journal").touch()
    (tmp_path / "noise.journal").write_bytes(bytes(range(256)) * 100)
    (tmp_path / "folder.journal").mkdir()
    write_journal(tmp_path, "odd", ["P03"], {"task": 1}, "registered")
    progress = TraineeHistory(tmp_path)
    assert "task-1" in progress.done["P01", HEAD]
    assert "task-1" not in progress.done["P02", HEAD]


def test_a_missing_folder_counts_for_nothing(tmp_path):
    assert "task-1" not in TraineeHistory(tmp_path / "later").done["P01", HEAD]
