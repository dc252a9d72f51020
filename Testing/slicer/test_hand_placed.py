"""Point lists of the scene as tasks: which are used, which omitted and why, which refused."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.sections.new_scenario_logic import handPlacedLists
from rastrainer.slicer.scene.nodes import ROLE_ATTRIBUTE, setPoints


def add_list(scene, name, count=15, labels=None):
    node = scene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", name)
    labels = labels or [f"{name}-{number}" for number in range(1, count + 1)]
    setPoints(node, labels, np.arange(3.0 * count).reshape(count, 3))
    return node


def test_lists_of_the_wrong_length_and_a_seventh_list_are_left_out_and_named(scene):
    add_list(scene, "Short", 14)
    chosen = add_list(scene, "Chosen", 16)
    chosen.SetNthControlPointSelected(15, False)
    good = [chosen, *(add_list(scene, f"Task {letter}") for letter in "ABCDEF")]
    add_list(scene, "Long", 16)
    half = add_list(scene, "Half")
    half.UnsetNthControlPointPosition(3)
    ours = add_list(scene, "Touched points", 7)
    ours.SetAttribute(ROLE_ATTRIBUTE, "touched")
    targets = add_list(scene, "Targets", 2)
    taken, left_out = handPlacedLists(scene, targets)
    assert [used.labels[0] for used in taken] == [
        node.GetNthControlPointLabel(0) for node in good[:6]
    ]
    assert left_out == [
        "The point list Short is left out: it has 14 points that are placed and selected, not 15.",
        "The point list Task F is left out: a scenario has at most 6 tasks.",
        "The point list Long is left out: it has 16 points that are placed and selected, not 15.",
        "The point list Half is left out: it has 14 points that are placed and selected, not 15.",
    ]


def test_a_scene_without_such_a_list_and_a_list_without_an_order_are_refused_by_name(scene):
    add_list(scene, "Short", 14)
    with pytest.raises(InputError, match=r"no point list of 15.*Short is left out: it has 14"):
        handPlacedLists(scene, None)
    add_list(scene, "Mixed", labels=["nose", *[str(number) for number in range(2, 16)]])
    with pytest.raises(InputError, match=r"The point list Mixed cannot be used: .* no number"):
        handPlacedLists(scene, None)
