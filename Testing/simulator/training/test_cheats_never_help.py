"""On random heads and tasks, no cheat gets more points than the same hands get without it."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from rastrainer.commands import CommandName
from rastrainer.head.mesh import HeadMesh
from rastrainer.json_records import record_from_json
from rastrainer.protocol import TouchRule
from rastrainer.scenario.points import LABELS, Task, task_file
from rastrainer.scenario.scenario import load_scenario
from rastrainer.scenario.writer import HeadDraft, write_scenario
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.analysis import RevealedTruth, analyze_trial
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.score_reference import fiducial_normals
from rastrainer.trial.scoring import SAFETY_METRICS
from rastrainer_simulator.authoring.make import ScenarioOptions, without_tasks
from rastrainer_simulator.training.rules import TrainingSettings
from Testing.domain.trial.trial_records import make_record
from Testing.error_rates.registered import errors_along_skin
from Testing.simulator.authoring.heads import egg
from Testing.simulator.training.hand_driven import Trial

HEADS, HANDS = (0, 1), (0,)
MORE_HEADS, MORE_HANDS = (2, 3), (1, 2)
"""Of `make soak`."""
FLE_MM, BIAS_MM = 1.0, 2.0
ANY_HEIGHT = TrainingSettings(touch_rule=TouchRule.WITHIN_RADIUS)


def _with_soak(always, more):
    return [*always, *(pytest.param(each, marks=pytest.mark.soak) for each in more)]


@pytest.fixture(scope="module", params=_with_soak(HEADS, MORE_HEADS))
def scenario(request, tmp_path_factory):
    """A head of random size and shape with one task of random fiducials above its base."""
    random = np.random.default_rng(request.param)
    mesh = egg()
    head = HeadMesh(mesh.vertices * random.uniform(0.85, 1.1, 3), mesh.triangles)
    # A patch of skin, and all of it.
    center = random.normal(size=3)
    center[2] = abs(center[2])
    width = random.uniform(60.0, 200.0)
    away = np.linalg.norm(head.vertices - center / np.linalg.norm(center) * 90.0, axis=1)
    places = head.vertices[(head.vertices[:, 2] > -40.0) & (away < width)]
    task = Task("task-1", "Task 1", task_file("task-1"), 10.0, fiducials=_apart(places, random))
    options = ScenarioOptions("random", "random", "none")
    made = replace(without_tasks(HeadDraft(head, "made up"), options), tasks=(task,))
    folder = tmp_path_factory.mktemp("head")
    write_scenario(folder, made, head, None, None)
    return load_scenario(folder)


def _apart(places, random):
    """Return fifteen of the points, as far apart as a random order allows."""
    for distance in (20.0, 15.0, 10.0, 5.0):
        chosen = []
        for place in random.permutation(places):
            if all(np.linalg.norm(place - other) >= distance for other in chosen):
                chosen.append(place)
        if len(chosen) >= len(LABELS):
            return np.array(chosen[: len(LABELS)])
    raise AssertionError("The patch is too small.")


@dataclass
class Hands:
    """Errors of fifteen touches, (15, 3) float, RAS mm, and the seconds that each takes."""

    errors: np.ndarray
    seconds: np.ndarray
    undone_row: int

    @classmethod
    def of(cls, scenario, seed):
        random = np.random.default_rng(100 + seed)
        normals = fiducial_normals(scenario, "task-1")
        (errors,) = errors_along_skin(normals, FLE_MM, 1, random)
        return cls(errors, random.uniform(3.0, 8.0, 15), int(random.integers(15)))

    def off_by(self, errors):
        """Return the same hands with more error."""
        return replace(self, errors=self.errors + errors)


def score_of(scenario, hands, meanwhile=lambda _trial: None, settings=None):
    """Play a trial and return its score; `meanwhile` comes after the touch to be taken back."""
    others = {} if settings is None else {"settings": settings}
    trial = Trial(scenario, **others)
    trial.start("task-1")
    truth, fiducials = trial.training.truth, scenario.task("task-1").fiducials

    def touch(row):
        trial.now += hands.seconds[row]
        place = truth.in_world(fiducials[row] + hands.errors[row])
        reply = trial.do(CommandName.CAPTURE, tuple(place / MM_PER_M))
        assert reply.ok, reply.message

    for row in range(len(fiducials)):
        touch(row)
        if row == hands.undone_row:
            meanwhile(trial)
            if len(trial.state.touches) == row:
                touch(row)
    seconds = trial.do(CommandName.REGISTER).data["completionTimeS"]
    record = make_record(completionTimeS=seconds, motion=dict.fromkeys(SAFETY_METRICS, 0.0))
    for point, kept in zip(record["points"], trial.state.touches, strict=True):
        point["positionMm"] = [MM_PER_M * value for value in kept.position]
    pose = RevealedTruth(tuple(truth.head_to_world.ravel().tolist()), 0.0)
    return (
        analyze_trial(record_from_json(TrialRecord, record), scenario).scored(scenario, pose).score
    )


@pytest.fixture(params=_with_soak(HANDS, MORE_HANDS))
def hands(request, scenario):
    return Hands.of(scenario, request.param)


def test_undoing_and_repeating_a_touch_costs_its_time(scenario, hands):
    honest = score_of(scenario, hands)
    undone = score_of(scenario, hands, lambda trial: trial.do(CommandName.UNDO))
    assert undone.measures.completion_time_s > honest.measures.completion_time_s + 3.0
    assert undone.score < honest.score


def test_waiting_in_a_pause_changes_no_score(scenario, hands):
    def wait(trial):
        trial.do(CommandName.PAUSE)
        trial.now += 300.0
        trial.do(CommandName.RESUME)

    # After the last touch there is nothing to pause.
    hands = replace(hands, undone_row=hands.undone_row % 14)
    honest, waited = (score_of(scenario, hands, each) for each in (lambda _trial: None, wait))
    assert waited.score == pytest.approx(honest.score, abs=1e-9)


def test_a_bias_of_two_millimeters_never_helps(scenario, hands):
    random = np.random.default_rng(7)
    normals, honest = fiducial_normals(scenario, "task-1"), score_of(scenario, hands)
    for direction in random.normal(size=(4, 3)):
        bias = BIAS_MM * direction / np.linalg.norm(direction)
        beside = score_of(scenario, hands.off_by(bias - normals * (normals @ bias)[:, None]))
        assert beside.score < honest.score
        assert beside.score <= 40.0


@pytest.mark.parametrize("height_mm", [2.0, 5.0, 9.0])
def test_hovering_never_helps(scenario, hands, height_mm):
    """Chance may decide below that: a height of 1 mm is within the scatter of these hands."""
    normals = fiducial_normals(scenario, "task-1")
    honest = score_of(scenario, hands, settings=ANY_HEIGHT)
    # Touches above each fiducial, and off all fiducials by the same vector.
    for offset in (normals, np.tile(normals.mean(axis=0), (15, 1))):
        # The errors along the skin must not take a touch out of its fiducial's reach.
        away = 0.9 * height_mm * offset / np.linalg.norm(offset, axis=1, keepdims=True)
        above = score_of(scenario, hands.off_by(away), settings=ANY_HEIGHT)
        assert above.score < honest.score
