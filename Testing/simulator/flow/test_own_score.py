"""A trial that ends where no Slicer is connected is scored by the simulator, and by it alone."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from rastrainer.journal.folder import journals_of
from rastrainer.journal.journal_file import read_journal
from rastrainer.protocol import Phase
from rastrainer.study_messages import StudyStep
from rastrainer.trial.scoring import SCORE_VERSION
from rastrainer_simulator.presentation.screen import Tone

OWN = "This score is the simulator's own and is not stored in a study."
A_MICROMETER = 1e-3


@pytest.fixture(scope="module")
def shared(simulation):
    return simulation


@pytest.fixture
def presenter(loop, outside):
    outside.services = replace(outside.services, scores_alone=True)
    presenter = outside.presenter(loop, view="never")
    yield presenter
    presenter.close()


def register(trainee):
    """Play Task 1 and register it; return the trial's UUID."""
    trainee.start("task-1")
    trainee.touch_anywhere()
    return trainee.register()


def entries_of(outside, trial_id, kind):
    (path,) = journals_of(outside.services.records, trial_id)
    return [entry["arguments"] for entry in read_journal(path).of_kind(kind)]


def errors_are_drawn_as_revealed(trainee, registration):
    """Check the arrows on the head: the revealed errors of the touches, 5 times as long."""
    revealed = trainee.submit("SubmitRegistration", **registration).data["touchErrorsMm"]
    trainee.choose("errors", None)
    arrows = trainee.presenter.screen.errors
    lengths_mm = [1000 * math.dist(arrow.begin, arrow.end) for arrow in arrows]
    assert lengths_mm == pytest.approx([5 * error for error in revealed.values()])
    tones = [arrow.tone for arrow in arrows]
    assert tones == [
        Tone.GOOD if error <= 2 else Tone.ERROR if error >= 4 else Tone.WARNING
        for error in revealed.values()
    ]
    trainee.tap_until("back", "result")
    assert trainee.presenter.screen.errors == ()


def test_without_slicer_the_trainee_gets_the_simulators_own_score_until_slicers_replaces_it(
    trainee, outside
):
    outside.has_slicer = True
    trainee.step(2)
    outside.has_slicer = False
    trial = register(trainee)
    # A Slicer that returns within seconds finds the trial unscored.
    trainee.step(150)
    assert entries_of(outside, trial, "registration") == []
    assert "the simulator is registering and scoring" in trainee.menu.paragraphs[0]
    trainee.until_menu("result")
    assert any(sentence.startswith(OWN) for sentence in trainee.menu.paragraphs)
    (submitted,) = entries_of(outside, trial, "registration")
    errors_are_drawn_as_revealed(trainee, submitted)
    (own,) = entries_of(outside, trial, "scored")
    assert own["details"]["scoreVersion"] == SCORE_VERSION
    # After the truth is revealed no other registration is accepted, not even by a micrometer.
    moved = [*submitted["matrix"][:3], submitted["matrix"][3] + A_MICROMETER]
    other = {**submitted, "matrix": [*moved, *submitted["matrix"][4:]]}
    refused = trainee.submit("SubmitRegistration", **other)
    assert (refused.ok, "final" in refused.message) == (False, True)
    assert "trueTreMm" in trainee.submit("SubmitRegistration", **submitted).data
    details = {key: value for key, value in own["details"].items() if key != "scoredBySimulator"}
    outside.has_slicer = True
    assert trainee.submit("TrialScored", trialId=trial, score=own["score"], details=details).ok
    trainee.until(lambda: not any(OWN in sentence for sentence in trainee.menu.paragraphs))
    assert trainee.menu.name == "result"


def test_the_simulator_scores_nothing_with_slicer_connected_or_a_study_running(trainee, outside):
    outside.has_slicer = True
    trial = register(trainee)
    trainee.step(150)
    assert trainee.menu.name == "waiting"
    assert "3D Slicer is scoring" in trainee.menu.paragraphs[0]
    trainee.choose("menu", "experiment")
    outside.services.assigned.take_step(StudyStep("P07", "trial", 1, 9, "task-1", "desktop"))
    outside.has_slicer = False
    trial_of_study = register(trainee)
    # Longer than the wait for a lost connection.
    trainee.step(500)
    assert trainee.menu.name == "waiting"
    assert "it will score them as soon as it is" in trainee.menu.paragraphs[0]
    for one in (trial, trial_of_study):
        assert entries_of(outside, one, "registration") == []


def commands_of(outside, trial_id, name):
    (path,) = journals_of(outside.services.records, trial_id)
    return [entry for entry in read_journal(path).of_kind("command") if entry["name"] == name]


def do(trainee, command, **arguments):
    answer = trainee.submit(command, **arguments)
    assert answer.ok, answer.message


def to_verifying(trainee):
    """Touch Task 1 of a trial with a biopsy and register it; return the trial's UUID."""
    trainee.start("task-1", procedure="biopsy")
    trainee.touch_anywhere()
    do(trainee, "Register")
    trainee.until(lambda: trainee.state.training.phase is Phase.VERIFYING, "the verification")
    return trainee.state.training.trial_id


def is_in_use(trainee):
    procedure = trainee.state.training.procedure
    return procedure is not None and procedure.registration is not None


def test_without_slicer_the_simulator_registers_a_procedure(trainee, outside):
    # A running study keeps it from scoring alone; registering reveals nothing.
    outside.services.assigned.take_step(StudyStep("P07", "trial", 1, 9, "task-1", "desktop"))
    # While a Slicer is connected, it registers the trial.
    outside.has_slicer = True
    trial = to_verifying(trainee)
    trainee.step(150)
    assert not is_in_use(trainee)
    outside.has_slicer = False
    trainee.until(lambda: is_in_use(trainee), "a registration in use")
    (used,) = commands_of(outside, trial, "UseRegistration")
    assert used["sender"] == "simulator"
    do(trainee, "AcceptRegistration")
    do(trainee, "Abort")
    assert entries_of(outside, trial, "registration") == []
