"""What the table of equal scores is made of: registrations, references and heads."""

import json

import numpy as np
import pytest

from rastrainer.registration.registration import register
from rastrainer.scenario.fiducial_normals import fiducial_normals
from rastrainer.trial.brain_region import region_of
from rastrainer.trial.score_reference import score_reference
from Testing.error_rates.equal_hands import HEADS, registered_errors, scenario_of, true_errors
from Testing.error_rates.played import TASKS
from Testing.simulator.authoring import planned_heads


@pytest.mark.parametrize("task", ["trial-run", "task-5"])
@pytest.mark.parametrize("head", HEADS)
def test_the_reference_error_is_what_errors_along_the_skin_leave(head, task):
    scenario = scenario_of(head)
    errors = true_errors(scenario, task, 1.0, 1500, np.random.default_rng(3))
    fiducials = np.asarray(scenario.task(task).fiducials, dtype=float)
    normals = fiducial_normals(scenario, task)
    expected = region_of(scenario).tre_per_fle(fiducials, normals)
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(expected, rel=0.05)


def test_many_registrations_at_once_are_those_of_the_program():
    scenario, random = scenario_of("colin27"), np.random.default_rng(4)
    fiducials = np.asarray(scenario.task("task-3").fiducials, dtype=float)
    moving = fiducials + random.normal(0.0, 2.0, (20, 15, 3)) + [5.0, -3.0, 8.0]
    region = region_of(scenario)
    expected = [region.tre_mm(register(one, fiducials).matrix, np.eye(4)) for one in moving]
    assert registered_errors(region, fiducials, moving) == pytest.approx(expected, abs=1e-9)


def test_the_tasks_of_colin27_are_to_take_the_published_mean_time():
    scenario = scenario_of("colin27")
    times_s = [score_reference(scenario, task).time_s for task in TASKS[1:]]
    assert np.mean(times_s) == pytest.approx(127.0, abs=1.0)


@pytest.mark.soak
@pytest.mark.parametrize("head", planned_heads.HEADS)
def test_the_heads_have_the_tasks_that_the_planner_proposes(head):
    kept = json.loads(planned_heads.FILE.read_text(encoding="utf-8"))[head]
    again = planned_heads.as_json(planned_heads.proposed(head))
    for one, other in zip(kept, again, strict=True):
        assert one["name"] == other["name"]
        assert np.allclose(one["fiducials"], other["fiducials"], atol=1e-3)
