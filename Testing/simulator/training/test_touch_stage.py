"""Contact is the goal at the next point, and an error everywhere else."""

import pytest

from rastrainer.protocol import Phase, Proximity
from rastrainer_simulator.state import TouchStage, TrainingState
from rastrainer_simulator.training.rules import TouchMoment, TrainingSettings, touch_stage
from rastrainer_simulator.trial_state import TouchState, TraceState

RUNNING = TrainingState(phase=Phase.RUNNING, next_point="2")
TOUCHED = TrainingState(
    phase=Phase.COMPLETE, touches=(TouchState("15", (0.0, 0.0, 0.0), 1.0, 1.0),)
)
TRACING = TrainingState(phase=Phase.RUNNING, trace=TraceState(is_on=True))
HERE, BESIDE = (0.0, 0.0, 0.0), (0.02, 0.0, 0.0)
CONTACT = Proximity.CONTACT


@pytest.mark.parametrize(
    ("proximity", "clearance", "depth", "obstacle", "training", "goal", "stage"),
    [
        (Proximity.FREE, 0.05, 0.0, "", RUNNING, HERE, TouchStage.FAR),
        (Proximity.PROXIMITY, 0.015, 0.0, "", RUNNING, HERE, TouchStage.NEAR),
        (CONTACT, 0.0, 0.0004, "", RUNNING, HERE, TouchStage.ON_SKIN),
        (CONTACT, 0.0, 0.0014, "", RUNNING, HERE, TouchStage.PRESSED),
        (CONTACT, 0.0, 0.0016, "", RUNNING, HERE, TouchStage.TOO_DEEP),
        (CONTACT, 0.0, 0.0006, "", RUNNING, BESIDE, TouchStage.ELSEWHERE),
        (CONTACT, 0.0, 0.0006, "", TRACING, None, TouchStage.PRESSED),
        (CONTACT, 0.004, 0.0, "", RUNNING, HERE, TouchStage.SHAFT),
        (CONTACT, 0.0, 0.0, "links", RUNNING, HERE, TouchStage.ARM),
        (Proximity.FREE, 0.05, 0.0, "table", RUNNING, HERE, TouchStage.ARM),
        (CONTACT, 0.0, 0.0, "", TOUCHED, None, TouchStage.NEAR),
        (CONTACT, 0.0, 0.0, "", TrainingState(), None, TouchStage.NEAR),
    ],
)
def test_each_touch_stage_is_recognized(
    proximity, clearance, depth, obstacle, training, goal, stage
):
    now = TouchMoment(1.0, HERE, clearance, depth)
    assert touch_stage(now, proximity, obstacle, training, goal, TrainingSettings()) is stage
