"""Robot and head stand on the table in every trial, or a sentence says what does not."""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.head.trial_head import Perturbation
from rastrainer.scenario.scenario import OperatingTable, load_scenario
from rastrainer.scenario.setup import USUAL_TABLE, HeadPlace, SetUp
from rastrainer.scenario.writer import HeadDraft
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.authoring.make import ScenarioOptions, without_tasks
from rastrainer_simulator.authoring.scenario_check import check_standing, lowest_in_trials_mm
from Testing.simulator.authoring.heads import colin27, egg


def standing(setup):
    """Return the faults of the position of an egg-shaped head."""
    return check_standing(scenario_of(setup), egg())


def scenario_of(setup):
    return without_tasks(
        HeadDraft(egg(), "made up"), ScenarioOptions("Egg", "made up", "none", setup)
    )


@pytest.mark.parametrize(
    ("setup", "sentence"),
    [
        pytest.param(
            SetUp(table=replace(USUAL_TABLE, center_mm=(800.0, 0.0))),
            "robot's foot",
            id="robot beside it",
        ),
        pytest.param(
            SetUp(table=OperatingTable((0.0, 0.0), (1050.0, 1000.0, 40.0))),
            "head's stand",
            id="a trial's head over its edge",
        ),
        pytest.param(
            SetUp(HeadPlace((480.0, 0.0, 110.0)), Perturbation(0.0, 0.0, 40.0)),
            "mm into the table",
            id="head tilted into it",
        ),
    ],
)
def test_anything_not_standing_on_the_table_is_reported(setup, sentence):
    sentences = standing(setup)
    assert sentence in sentences[0]
    assert "\n" not in sentences[0]


def test_the_default_setup_and_the_bundled_scenario_stand_on_the_table():
    assert standing(SetUp()) == []
    scenario = load_scenario(asset_path("scenarios", "colin27"))
    assert check_standing(scenario, colin27()) == []


def test_no_trial_places_the_head_lower_than_reported():
    setup = SetUp(perturbation=Perturbation(20.0, 30.0, 25.0))
    scenario, head = scenario_of(setup), egg()
    reported = lowest_in_trials_mm(scenario, head)
    lowest = [
        transforms.apply(scenario.perturbed_head_to_world(seed), head.vertices)[:, 2].min()
        for seed in range(100)
    ]
    assert reported <= min(lowest)
    assert reported > min(lowest) - 15.0
    still = replace(scenario, perturbation=Perturbation(0.0, 0.0, 0.0))
    world = transforms.apply(still.head_to_world, head.vertices)
    assert lowest_in_trials_mm(still, head) == pytest.approx(np.min(world[:, 2]))
