"""The module connected to a simulator double that tells it of a trial."""

import json
import uuid

from rastrainer.igtl.content import String
from rastrainer.protocol import DeviceName
from Testing.slicer.simulator_double import connect_module


class ToldModule:
    """The module in the host, connected."""

    def __init__(self, host, simulator):
        self.host, self.simulator = host, simulator
        host.open()
        connect_module(host, simulator)

    def tell(self, **state):
        """Send the state of a trial of task 1, which is running unless the state says otherwise."""
        usual = {"trialId": str(uuid.UUID(int=5)), "trainee": "T001", "task": "task-1"}
        values = {**usual, "phase": "running", **state}
        self.simulator.send(DeviceName.SIM_STATE, String(json.dumps(values)))
