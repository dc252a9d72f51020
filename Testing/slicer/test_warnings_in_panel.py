"""Faults of touches: the panel names the points, and offers remedies."""

import numpy as np
import pytest
from PySide6 import QtWidgets

from rastrainer.scenario.points import LABELS
from rastrainer.slicer.scene.nodes import Role, setPoints
from rastrainer.transforms import MM_PER_M
from Testing.slicer.recorded_trial import touches_on_colin

ALL = ", ".join(LABELS)


@pytest.fixture
def panel(host):
    """The section Registration, open, with the fiducials of task 1 in the scene."""
    host.open()
    host.press("showScenarioButton")
    host.find("registrationCollapsibleButton").collapsed = False
    host.process_events()
    return host


def touch(host, points):
    """Put touches into the scene, and wait until the panel has processed them."""
    host.finish_work()
    host.find("registrationText").text = ""
    setPoints(Role.CAPTURED_POINTS.make(host.scene), LABELS[: len(points)], points)
    host.wait_until(lambda: host.text("registrationText"), "the touches are registered")


def warnings(host):
    labels = host.find("warningsWidget")._qt.findChildren(QtWidgets.QLabel)
    return [label.text() for label in labels]


MENDED = {
    "reversed": (lambda points: points[::-1], f"({ALL}) are in reverse order", "Put in order"),
    "one bad touch": (
        lambda points: points + np.outer(np.arange(15) == 6, [9.0, -6.0, 5.0]),
        "Point 7 lies",
        "Leave out 7",
    ),
}


def test_one_click_fixes_a_fault_and_undo_reverts_it(panel):
    touches = touches_on_colin()
    for case, (change, named, button) in MENDED.items():
        touch(panel, change(touches))
        assert named in " ".join(warnings(panel)), case
        number = next(n for n, text in enumerate(warnings(panel)) if named in text)
        assert panel.text(f"remedy{number}Button") == button, case
        panel.press(f"remedy{number}Button")
        panel.finish_work()
        assert named not in " ".join(warnings(panel)), case
        left = button.removeprefix("Leave out ")
        assert (f"Left out: {left};" in panel.text("registrationText")) == (left != button), case
        assert panel.find("residualsTable").rowCount == (15 if left == button else 14), case
        panel.press("undoButton")
        panel.finish_work()
        assert named in " ".join(warnings(panel)), case
        assert panel.find("residualsTable").rowCount == 15, case


def test_a_warning_without_a_remedy_names_its_points_and_good_touches_raise_none(panel):
    touches = touches_on_colin()
    for points, named, advice in (
        (touches * [1, 1, -1], f"({ALL}) are a mirror image", "check the sign"),
        (touches / MM_PER_M, f"({ALL}) are 998.9 times", "must be in millimeters"),
        (touches[:2], "", "at least 3"),
    ):
        touch(panel, points)
        text = " ".join([*warnings(panel), panel.text("registrationText")])
        assert named in text
        assert advice in text
    touch(panel, touches)
    assert warnings(panel) == []
    assert panel.find("residualsTable").rowCount == 15
