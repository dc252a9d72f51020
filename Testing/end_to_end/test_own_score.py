"""The simulator's own score is Slicer's, to the last digit; Slicer's takes its place."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest

from rastrainer.commands import check_arguments
from rastrainer.errors import InputError
from rastrainer.journal.entries import Stamp
from rastrainer.journal.folder import journals_of
from rastrainer.journal.journal_file import read_journal
from rastrainer.scenario.scenario import load_scenario
from rastrainer.sections.trial_logic import TrialLogic
from rastrainer.study.database.study import Study
from rastrainer.trial.ctps import PUBLISHED_STUDY, read_trials
from rastrainer.trial.scoring import SCORE_VERSION
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.flow.session.trainee_history import TraineeHistory
from rastrainer_simulator.record.trial_archive import TrialArchive
from rastrainer_simulator.training.local_scorer import (
    SCORED_BY_SIMULATOR,
    registered_alone,
    score_alone,
)
from Testing.end_to_end.faulty_proxy import SlicerSide
from Testing.end_to_end.finished_trials import COLIN, TRAINEE, write_finished_trials
from Testing.end_to_end.simulator_process import SimulatorProcess

TIMEOUT_S = 600.0
TOO_MANY_AT_ONCE = "Trials arrive faster than they can be scored; they will be offered again later."


@pytest.fixture(scope="module")
def scenario():
    return load_scenario(COLIN)


@pytest.fixture(scope="module")
def cohort():
    return read_trials(asset_path(*PUBLISHED_STUDY))


class Alone:
    """A folder of trials without a connected client, scored as the simulator does."""

    def __init__(self, folder, count, scenario):
        folder.mkdir()
        self.folder = folder
        self.trials = write_finished_trials(folder, range(count))
        self.history = TraineeHistory(folder)
        self._archive = TrialArchive(folder)
        for trial in self.trials:
            analysis = registered_alone(self.ask, trial, scenario)
            score_alone(self.ask, analysis, scenario, self.history.own(TRAINEE), folder)
            self.history.changed(TRAINEE, trial)

    def ask(self, command, arguments):
        return self._archive.answer(command, check_arguments(command, arguments), Stamp.now(0, 0.0))

    def entries(self, trial, kind):
        (path,) = journals_of(self.folder, trial)
        return [entry["arguments"] for entry in read_journal(path).of_kind(kind)]


def without_its_mark(scored):
    details = {key: value for key, value in scored["details"].items() if key != SCORED_BY_SIMULATOR}
    return {**scored, "details": details}


def test_a_trial_is_not_scored_on_another_head_that_was_loaded_afterward(tmp_path, scenario):
    alone = Alone(tmp_path / "alone", 0, scenario)
    (trial,) = write_finished_trials(alone.folder, range(1))
    with pytest.raises(InputError, match=r"was played in the scenario colin27, but other is"):
        registered_alone(alone.ask, trial, replace(scenario, name="other"))
    assert alone.entries(trial, "registration") == []


@pytest.mark.parametrize("count", [3, pytest.param(100, marks=pytest.mark.soak)])
def test_slicer_connecting_later_stores_the_trial_and_its_score_replaces_the_identical_one(
    tmp_path, scenario, cohort, count
):
    alone = Alone(tmp_path / "alone", count, scenario)

    find, make = lambda _name: scenario, lambda services: TrialLogic(services, cohort)
    with SimulatorProcess(alone.folder, "--no-views") as simulator:
        slicer = SlicerSide(tmp_path / "study.db", simulator.port, make, find, alone.folder)
        scored, problems = [], []
        slicer.logic.trialScored.connect(scored.append)
        slicer.logic.problemFound.connect(problems.append)
        give_up = time.monotonic() + TIMEOUT_S
        while len(scored) < count and time.monotonic() < give_up:
            slicer.run_for(10)
        slicer.close()
        assert simulator.stop()[0] == 0
    # A busy machine takes them in several turns.
    assert set(problems) <= {TOO_MANY_AT_ONCE}
    assert len(scored) == count
    for analysis in scored:
        trial = analysis.record.trial_id
        (registered,) = alone.entries(trial, "registration")
        assert registered["matrix"] == analysis.rigid.matrix.ravel().tolist()
        own, slicers = alone.entries(trial, "scored")
        assert SCORED_BY_SIMULATOR not in slicers["details"]
        # Many trials arrive out of order, and are compared with those already stored.
        for entry in (own, slicers):
            del entry["details"]["feedback"]
        assert without_its_mark(own) == slicers
    with Study.open(tmp_path / "study.db") as study:
        assert {study.trial(trial).score.version for trial in alone.trials} == {SCORE_VERSION}
