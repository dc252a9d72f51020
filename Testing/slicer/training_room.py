"""The training logic on a link to a simulator double, for the tests of what steers trials."""

import json
import uuid

from rastrainer.igtl.content import Status, String
from rastrainer.protocol import PROTOCOL_VERSION, DeviceName
from rastrainer.sections.training_logic import TrainingLogic
from rastrainer_simulator.texts.texts import ENGLISH
from Testing.slicer.simulator_double import LinkedLab

TRIAL = str(uuid.UUID(int=5))
LOADING_REFUSAL = ENGLISH["being set up"]


class Room(LinkedLab):
    """A logic on a link to a simulator double that has the ball scenario.

    As the simulator does, it begins neither a trial nor another loading while `isLoading`.
    """

    def __init__(self, scene, scenario):
        super().__init__(scene, self.answer)
        self.now, self.refusal = 100.0, None
        self.needsTutorial = self.isLoading = False
        self.logic = TrainingLogic(scene, self.link, lambda _name: scenario, lambda: self.now)
        self.answers = []
        self.logic.answered.connect(self.answers.append)
        self.connect()
        self.simulator.send(DeviceName.SIM_SERVER, Status(Status.OK, subcode=PROTOCOL_VERSION))

    def answer(self, name, _arguments):
        if name == "ListTasks":
            return {"scenario": "ball", "title": "Ball", "tasks": []}
        if name == "StartTutorial" and self.refusal is None:
            return {"isNeeded": self.needsTutorial}
        if name in ("StartTask", "LoadScenario") and self.isLoading:
            return LOADING_REFUSAL
        return {} if self.refusal is None or name == "Hello" else self.refusal

    def tell(self, **state):
        values = {"trialId": TRIAL, "phase": "running", "task": "task-1", "trainee": "T001"}
        self.simulator.send(DeviceName.SIM_STATE, String(json.dumps({**values, **state})))

    def node(self, role):
        return role.find(self.scene)

    def close(self):
        self.logic.close()
        super().close()
