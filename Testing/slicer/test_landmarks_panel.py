"""Landmarks are placed, replaced, removed and restored in Slicer, and saved in the scenario."""

from __future__ import annotations

import pytest

from rastrainer.scenario.library import user_library
from rastrainer.scenario.scenario import load_scenario
from rastrainer.sections.landmarks_logic import LandmarkPoints
from Testing.end_to_end.module.story import Story

COLIN27 = ["Nasion", "Left tragus", "Right outer canthus"]
COLIN27 += ["Right inner canthus", "Left inner canthus"]


def names(host):
    return [row[0] for row in host.cells("landmarksTable")]


def test_landmarks_are_placed_by_clicks_and_each_change_is_undone(fresh_module):
    host = fresh_module
    assert not host.find("undoLandmarkButton").enabled
    assert not host.find("saveLandmarksButton").enabled
    host.press("placeLandmarkButton")
    host.place(1.0, 84.0, -40.0)
    host.wait_until(lambda: names(host) == ["Nasion"], "the landmark is shown")
    assert host.find("landmarkNameComboBox").currentText == "Right outer canthus"
    host.press("placeLandmarkButton")
    host.place(52.0, 62.0, -42.0)
    host.wait_until(lambda: len(names(host)) == 2, "the second is shown")
    host.choose("landmarkNameComboBox", "Nasion")
    host.press("placeLandmarkButton")
    host.place(0.0, 85.0, -39.0)
    host.wait_until(lambda: names(host) == ["Right outer canthus", "Nasion"], "it is replaced")
    host.choose("landmarksTable", 0)
    host.press("removeLandmarkButton")
    assert names(host) == ["Nasion"]
    for left in (["Right outer canthus", "Nasion"], ["Nasion", "Right outer canthus"], ["Nasion"]):
        host.press("undoLandmarkButton")
        assert names(host) == left
    (nasion,) = LandmarkPoints(host.scene).placed()
    assert nasion.position_ras.tolist() == pytest.approx([1.0, 84.0, -40.0])


def test_a_scenarios_landmarks_are_shown_and_deselected_ones_left_out_which_is_said_and_kept(
    fresh_module,
):
    host = fresh_module
    host.choose("scenarioComboBox", 0)
    host.press("showLandmarksButton")
    assert names(host) == COLIN27
    assert host.find("landmarkNameComboBox").currentText == "Left outer canthus"
    node = host.scene.GetFirstNodeByName("Landmarks")
    node.SetNthControlPointSelected(1, False)
    host.wait_until(lambda: len(names(host)) == 4, "it is left out")
    assert "Left tragus" not in names(host)
    said = host.text("landmarksText")
    assert "Left out, as they are deselected in the module Markups: Left tragus." in said
    host.choose("landmarksTable", 1)
    host.press("removeLandmarkButton")
    assert names(host) == ["Nasion", *COLIN27[3:]]
    host.press("undoLandmarkButton")
    assert names(host) == ["Nasion", *COLIN27[2:]]
    assert not node.GetNthControlPointSelected(1)
    node.SetNthControlPointSelected(1, True)
    host.wait_until(lambda: names(host) == COLIN27, "it is back")
    assert "deselected" not in host.text("landmarksText")


@pytest.mark.soak
def test_landmarks_are_proposed_checked_and_saved_by_the_simulators_program(host, tmp_path):
    Story(host, tmp_path).choose_own_program()
    host.choose("scenarioComboBox", 0)
    host.press("proposeLandmarksButton")
    host.wait_until(lambda: len(names(host)) == 6, "the proposal is shown")
    assert "Right tragus is left out" in host.text("landmarksText")
    host.press("checkLandmarksButton")
    assert host.text("landmarksText") == "The landmarks can be used."
    host.choose("landmarkNameComboBox", "Right tragus")
    host.press("placeLandmarkButton")
    host.place(86.4, -22.8, -56.3)
    host.wait_until(lambda: len(names(host)) == 7, "it is placed")
    host.press("checkLandmarksButton")
    assert "The robot does not reach Right tragus" in host.text("landmarksText")
    host.press("undoLandmarkButton")
    host.type("landmarksTitleLineEdit", "My landmarks")
    host.press("saveLandmarksButton")
    saved = load_scenario(user_library() / "my-landmarks")
    assert sorted(each.name for each in saved.landmarks) == sorted([*COLIN27, "Left outer canthus"])
    assert host.find("scenarioComboBox").currentText == "My landmarks"
    assert host.messages == []
