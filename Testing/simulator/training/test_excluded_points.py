"""A registration of some touches only is refused, or changes no score."""

import dataclasses
import json

import numpy as np
import pytest

from rastrainer.commands import CommandName
from rastrainer.json_records import record_from_json
from rastrainer.registration.registration import register
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.analysis import RevealedTruth, analyze_trial
from rastrainer.trial.record import TrialRecord
from Testing.domain.trial.trial_records import make_record
from Testing.simulator.training.hand_driven import Trial

TASKS = ("trial-run", "task-3")
BAD_MM = 4.0
"""Errors of the five worst touches, along the skin or not."""
MOTION = {
    "unintended_contact_time_s": 0.0,
    "unintended_contact_path_mm": 0.0,
    "pressing_depth_mm": 0.2,
}


@dataclasses.dataclass
class Submitted:
    """A trial with five bad touches, and the result of a submitted registration."""

    reply: object
    record: TrialRecord
    all_touches: np.ndarray
    submitted: np.ndarray


def submit(scenario, task, choose):
    """Play a task whose last five touches are bad; submit the fit of the rows that are chosen."""
    trial = Trial(scenario)
    trial.start(task)
    random = np.random.default_rng(8)
    bad = np.repeat([0.0, BAD_MM], [10, 5])
    for size in bad:
        direction = random.normal(size=3)
        off = size * direction / np.linalg.norm(direction) / MM_PER_M
        place = np.array(trial.fiducial(trial.state.next_point)) + off
        reply = trial.do(CommandName.CAPTURE, tuple(place))
        assert reply.ok, reply.message
    assert trial.do(CommandName.REGISTER).ok
    touches = trial.state.touches
    record = make_record(task=task, motion=MOTION)
    for point, touch in zip(record["points"], touches, strict=True):
        point.update(label=touch.label, positionMm=[MM_PER_M * v for v in touch.position])
    record = record_from_json(TrialRecord, record)
    fiducials = np.asarray(scenario.task(task).fiducials, dtype=float)
    rows = choose(fiducials)
    fit = register(record.positions_mm[rows], fiducials[rows])
    reply = trial.do(
        CommandName.SUBMIT_REGISTRATION,
        matrix=tuple(float(value) for value in fit.matrix.ravel()),
        freMm=fit.fre_mm,
        expectedTreMm=0.1,
    )
    assert reply.ok, reply.message
    return Submitted(reply, record, register(record.positions_mm, fiducials).matrix, fit.matrix)


def everything(fiducials):
    return np.arange(len(fiducials))


def without_the_worst_five(_fiducials):
    return np.arange(10)


def one_side(fiducials):
    """Return the rows of the half of the fiducials that is farthest to one side."""
    return np.argsort(fiducials[:, 0])[:8]


@pytest.mark.parametrize("choose", [without_the_worst_five, one_side])
@pytest.mark.parametrize("task", TASKS)
def test_all_touches_are_scored_whatever_registration_was_submitted(scenario, task, choose):
    cheated, honest = (submit(scenario, task, rows) for rows in (choose, everything))
    assert not np.allclose(cheated.submitted, cheated.all_touches, atol=1e-3)
    scored = [
        analyze_trial(
            one.record,
            scenario,
            truth=record_from_json(RevealedTruth, json.loads(json.dumps(one.reply.data))),
        )
        for one in (cheated, honest)
    ]
    assert scored[0].score == scored[1].score
    assert np.array_equal(scored[0].rigid.matrix, cheated.all_touches)


@pytest.mark.parametrize("task", TASKS)
def test_each_touch_must_be_at_its_own_fiducial(scenario, task):
    trial = Trial(scenario)
    trial.start(task)
    first = trial.fiducial("1")
    trial.touch()
    assert not trial.do(CommandName.CAPTURE, first).ok
    assert trial.state.next_point == "2"
