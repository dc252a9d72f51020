"""A trial's procedure from Slicer: touches registered unasked, steps commanded, hostile state."""

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.scenario.points import LABELS
from rastrainer.sections.procedure_logic import ProcedureLogic
from rastrainer.sections.training_logic import ProcedureStatus, readStatus
from rastrainer.sections.trial_services import TrialServices
from Testing.slicer.training_room import TRIAL, Room

VERIFYING = {"name": "dbs", "trajectory": 0, "trajectories": 2, "registrationInUse": False}


class Theater(Room):
    """A room in which procedures are carried out."""

    def __init__(self, scene, scenario):
        self.touches, self.refused = [], ""
        super().__init__(scene, scenario)
        services = TrialServices(scene, self.link, lambda _name: scenario, None, self.work)
        self.procedure = ProcedureLogic(services)
        self.said = []
        self.procedure.answered.connect(self.said.append)
        places = transforms.apply(scenario.head_to_world, scenario.task("task-1").fiducials)
        self.touches = [
            {"label": label, "positionMm": place.tolist()}
            for label, place in zip(LABELS, places, strict=True)
        ]

    def answer(self, name, arguments):
        if name == self.refused:
            return "This is refused."
        if name == "GetTrial":
            return {"task": "task-1", "touches": self.touches}
        return super().answer(name, arguments)

    def say(self, phase, **procedure):
        self.tell(phase=phase, procedure={**VERIFYING, **procedure})
        self.run_until(lambda: self.procedure.status.phase == phase)

    def close(self):
        self.procedure.close()
        super().close()


@pytest.fixture
def theater(scene, scenario):
    theater = Theater(scene, scenario)
    yield theater
    theater.close()


def test_the_touches_are_registered_as_soon_as_the_procedure_waits_for_it(theater, scenario):
    theater.say("verifying")
    theater.run_until(lambda: theater.sent("UseRegistration"))
    (used,) = theater.sent("UseRegistration")
    assert used["trialId"] == TRIAL
    matrix = np.reshape(used["matrix"], (4, 4))
    np.testing.assert_allclose(matrix @ scenario.head_to_world, np.eye(4), atol=1e-9)
    assert used["freMm"] == pytest.approx(0.0, abs=1e-9)
    theater.say("verifying", registrationInUse=True)
    theater.run_until(lambda: theater.procedure.status.procedure.registrationInUse)
    assert len(theater.all_sent("UseRegistration")) == 1
    # Touches made again are registered again.
    theater.say("running")
    theater.say("verifying")
    theater.run_until(lambda: len(theater.sent("UseRegistration")) == 2)


def test_the_reason_why_touches_were_not_registered_is_shown_once(theater):
    theater.refused = "UseRegistration"
    theater.say("verifying")
    theater.run_until(lambda: theater.said)
    assert theater.said == ["The touches were not registered: This is refused."]
    assert theater.procedure.isRegistrationFailed
    theater.say("running")
    theater.run_until(lambda: not theater.procedure.isRegistrationFailed)


def test_a_malformed_procedure_state_causes_no_trouble():
    wrong = {"name": 3, "trajectory": "x", "trajectories": None, "feedMm": True}
    for procedure in (None, 7, [], wrong):
        status = readStatus({"trialId": TRIAL, "phase": "drilling", "procedure": procedure})
        assert (status.phase, status.procedure) == ("drilling", ProcedureStatus())
