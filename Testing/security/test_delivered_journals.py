"""A study with a protocol scores a trial only if it follows from the journal that came with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.journal.folder import journals_of
from rastrainer.journal.journal_file import NO_LINE, encode_line, read_journal
from rastrainer.json_records import record_from_json
from rastrainer.scenario.scenario import load_scenario
from rastrainer.sections.trial_logic import TrialLogic
from rastrainer.study.database.study import Study
from rastrainer.study.journal_check import check_journal
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.cli.main import main
from Testing.domain.study.played_study import STUDIES
from Testing.end_to_end.faulty_proxy import SlicerSide
from Testing.end_to_end.finished_trials import COLIN, write_finished_trials
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.end_to_end.test_trial_over_openigtlink import Player, play
from Testing.slicer.simulator_double import run_logic_until

TIMEOUT_S = 120.0


@pytest.fixture(scope="module")
def scenario():
    return load_scenario(COLIN)


@pytest.fixture(scope="module")
def played(tmp_path_factory, scenario):
    """The folder of a simulator in which a trial was played, and the trial's UUID."""
    records = tmp_path_factory.mktemp("played") / "records"
    with (
        SimulatorProcess(records, "--no-views", "--speed", "8") as simulator,
        Player(simulator.port) as player,
    ):
        return records, play(player, scenario)["StartTask"]["trialId"]


def received(folder, port, scenario, **protocol):
    """Receive one trial in a study with a protocol; return its score and the reported sentences."""
    path = folder / "study.db"
    with Study.open(path) as study:
        published = StudyProtocol.read(STUDIES / "published-protocol.json")
        StudyProgress(study).set_protocol(replace(published, **protocol))
    scored, problems = [], []
    slicer = SlicerSide(path, port, TrialLogic, lambda _name: scenario)
    slicer.logic.trialScored.connect(scored.append)
    slicer.logic.problemFound.connect(problems.append)
    try:
        # A problem may be one of this moment, after which the trial is asked for again.
        is_over = lambda: scored or (problems and is_revealed(path))  # noqa: E731
        run_logic_until(slicer.link, slicer.work, is_over, TIMEOUT_S)
        run_logic_until(slicer.link, slicer.work, lambda: not slicer.work.isBusy, TIMEOUT_S)
    finally:
        slicer.close()
    with Study.open(path) as study:
        ((name,),) = [[each.pseudonym for each in study.trainees()]]
        (trial,) = study.history(name)
        (attempt,) = study.attempts(name)
    assert attempt.is_aborted == (trial.score is None)
    return trial.score, problems


def is_revealed(path):
    with Study.open(path) as study:
        histories = [study.history(each.pseudonym) for each in study.trainees()]
        return any(trial.true_tre_mm is not None for trials in histories for trial in trials)


def test_a_trial_that_was_played_is_scored(played, scenario, tmp_path, capsys):
    records, trial = played
    with SimulatorProcess(records, "--no-views") as simulator:
        score, problems = received(tmp_path, simulator.port, scenario)
    assert problems == []
    assert score is not None
    study = ["--study", str(tmp_path / "study.db")]
    (path,) = journals_of(records, trial)
    assert main(["verify", str(path), *study]) == 0
    invented = tmp_path / "invented"
    invented.mkdir()
    write_finished_trials(invented, range(1))
    assert main(["verify", *map(str, invented.iterdir()), *study]) == 1
    assert "the study has no such finished trial" in capsys.readouterr().out


@pytest.mark.parametrize("is_checked", [True, False])
def test_an_invented_trial_in_a_real_simulator_is_scored_only_by_a_study_that_wants_it(
    tmp_path, scenario, is_checked
):
    records = tmp_path / "records"
    records.mkdir()
    write_finished_trials(records, range(1))
    with SimulatorProcess(records, "--no-views") as simulator:
        score, problems = received(tmp_path, simulator.port, scenario, check_journals=is_checked)
    assert (score is None) == is_checked
    assert [("was not scored: Its journal" in problem) for problem in problems] == [
        True
    ] * is_checked


@pytest.fixture(scope="module")
def evidence(played):
    """The entries of the played trial's journal."""
    records, trial = played
    return read_journal(journals_of(records, trial)[0]).entries


def sealed(entries):
    """Return a whole consistent chain, its record with the hash of its line, and its truth."""
    lines, previous = [], NO_LINE
    for number, entry in enumerate(entries, start=1):
        bare = {k: v for k, v in entry.items() if k not in ("n", "previous", "sha256")}
        line, previous = encode_line(number, previous, bare)
        lines.append(line)
        if entry["kind"] == "registered":
            record, sha256, truth = entry["record"], previous, entry["truth"]
    record = record_from_json(TrialRecord, record | {"journalSha256": sha256})
    return record, record_from_json(RevealedTruth, truth | {"trueTreMm": 0.0}), b"".join(lines)


def changed(entries, kind, **values):
    """Return entries with values in the last one of a kind; a function gets the old value."""
    last = max(n for n, entry in enumerate(entries) if entry["kind"] == kind)
    entry = dict(entries[last])
    for key, value in values.items():
        entry[key] = value(entry[key]) if callable(value) else value
    return [*entries[:last], entry, *entries[last + 1 :]]


def with_last_touch_moved(record):
    *points, last = record["points"]
    return record | {"points": [*points, last | {"positionMm": [500, 0, 300]}]}


FORGED = {
    "a better time": lambda entries: changed(
        entries, "registered", record=lambda old: old | {"completionTimeS": 20.0}
    ),
    "a touch where the tip was not": lambda entries: changed(
        changed(entries, "touch", positionMm=[500, 0, 300]),
        "registered",
        record=with_last_touch_moved,
    ),
    "no contact": lambda entries: changed(
        entries,
        "registered",
        record=lambda old: old | {"motion": dict.fromkeys(old["motion"], 0.0)},
    ),
    "an easier pose": lambda entries: changed(
        entries,
        "registered",
        truth=lambda old: old | {"headToWorld": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]},
    ),
    "another trainee": lambda entries: changed(entries, "header", trainee="bert"),
}


@pytest.mark.parametrize("forge", FORGED.values(), ids=FORGED)
def test_a_chain_that_is_whole_must_also_tell_of_the_trial(evidence, scenario, forge):
    check_journal(*sealed(evidence), scenario)
    with pytest.raises(InputError, match="Its journal tells otherwise"):
        check_journal(*sealed(forge(list(evidence))), scenario)


def test_an_altered_line_another_journal_and_another_pose_are_refused(evidence, scenario):
    record, truth, journal = sealed(evidence)
    lines = journal.splitlines(keepends=True)
    moved = replace(truth, head_to_world=tuple(np.eye(4).ravel()))
    with pytest.raises(InputError, match=r"Line 9 of its journal was altered"):
        check_journal(record, truth, b"".join(lines[:8] + lines[9:]), scenario)
    with pytest.raises(InputError, match="is not the one that was announced"):
        check_journal(replace(record, journal_sha256="0" * 64), truth, journal, scenario)
    with pytest.raises(InputError, match="the head's pose"):
        check_journal(record, moved, journal, scenario)
