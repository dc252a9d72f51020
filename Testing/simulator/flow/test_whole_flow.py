"""From the start menu to the result, as the paper's figure 4 has it."""

from __future__ import annotations

import numpy as np

from rastrainer.protocol import CommandName, Phase, check_arguments


def score(loop, trial_id):
    arguments = {
        "trialId": trial_id,
        "matrix": np.eye(4).ravel().tolist(),
        "freMm": 1.25,
        "expectedTreMm": 1.5,
        "score": 81.0,
        "details": {"ctps": 62.5, "warnings": []},
    }
    loop.submit("TrialScored", check_arguments("TrialScored", arguments), "Slicer").result(10)


def test_the_whole_flow_goes_by_keys_alone(trainee, outside):
    keys = trainee.hands
    trainee.choose("train")
    trainee.until_menu("introduction")
    trainee.tap("accept", "accept", "accept")
    trainee.until_menu("controls")
    trainee.choose("next")
    trainee.until_menu("experiment")
    trainee.focus("trainee")
    keys.type("P07")
    trainee.until(lambda: trainee.item("trainee").value == "P07")
    trainee.choose("trial-run")
    trainee.until_menu(None)
    trainee.tap("menu")
    trainee.until_menu("trial")
    trainee.choose("finish")
    trainee.until_menu("experiment")
    trainee.choose("task-1")
    trainee.until_menu(None)
    trainee.play("task-1")
    trainee.tap("touch")
    trainee.until_menu("complete")
    trainee.choose("register")
    trainee.until_menu("waiting")
    training = trainee.state.training
    assert (training.trainee, training.task, training.mode) == ("P07", "task-1", "desktop")
    outside.has_slicer = True
    score(trainee.loop, training.trial_id)
    trainee.until_menu("result")
    assert trainee.menu.facts[0].value == "81 / 100"
    trainee.choose("next")
    trainee.until_menu("experiment")
    assert trainee.menu.focus == "task-2"
