"""The promises of the default scenario: tasks that the robot can do, and the notice of its MRI."""

import json

import numpy as np
import pytest

from rastrainer.head.mesh import outward_normals, read_head_mesh
from rastrainer.registration.localization_error import LocalizationError
from rastrainer.registration.registration import register
from rastrainer.registration.target_error import expected_tre
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.authoring.task_proposal import target_spread

FOLDER = asset_path("scenarios", "colin27")
SCENARIO = load_scenario(FOLDER)
MESH = read_head_mesh(SCENARIO.head)


def test_the_fiducials_locate_the_center_of_the_head_well():
    for task in SCENARIO.tasks:
        same = register(task.fiducials, task.fiducials)
        unit = LocalizationError(np.tile(np.eye(3), (len(task.fiducials), 1, 1)), np.inf)
        target = SCENARIO.target.position_ras
        expected_mm = expected_tre(same, target[None], unit, common_bias_sd_mm=0.0)
        ratio = expected_mm[0] / np.sqrt(3)
        assert ratio < (0.7 if task.name == "trial-run" else 0.4)
        assert target_spread(task.fiducials, target) == pytest.approx(ratio**2)


@pytest.mark.parametrize("count", [1, pytest.param(20, marks=pytest.mark.soak)])
def test_the_robot_can_touch_every_fiducial_in_other_poses_of_the_head(count):
    planning = PlanningSetup(SCENARIO, MESH)
    fiducials = np.concatenate([task.fiducials for task in SCENARIO.tasks])
    normals = outward_normals(MESH, fiducials)
    seeds = range(90_000, 90_000 + count)
    poses = [SCENARIO.head_to_world, *map(SCENARIO.perturbed_head_to_world, seeds)]
    assert planning.touchable(fiducials, normals, poses).all()
    far = SCENARIO.head_to_world.copy()
    far[:3, 3] += [1000.0, 0.0, 0.0]
    assert not planning.touchable(fiducials[:2], normals[:2], [poses[0], far]).any()


def test_the_notice_of_the_mri_travels_with_the_scenario():
    content = json.loads((FOLDER / "scenario.json").read_text(encoding="utf-8"))
    assert "Louis Collins, McConnell Brain Imaging Centre" in content["provenance"]["license"]
