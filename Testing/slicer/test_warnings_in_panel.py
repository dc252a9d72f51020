"""Faults of touches: the panel names the points, and offers remedies."""

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.scenario.points import LABELS
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.scene.nodes import capturedPointsNode, setPoints
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.assets import asset_path

ALL = ", ".join(LABELS)
ONE_LINE = np.outer(np.arange(15), [9.0, 9.0, 9.0])


@pytest.fixture
def panel(host):
    """The section Registration, open, with the fiducials of task 1 in the scene."""
    host.open()
    host.press("showScenarioButton")
    host.find("registrationCollapsibleButton").collapsed = False
    host.process_events()
    return host


@pytest.fixture
def touches():
    """Good touches, (15, 3) float, World, mm."""
    colin = load_scenario(asset_path("scenarios", "colin27"))
    noise = np.random.default_rng(3).normal(0.0, 0.6, (15, 3))
    return transforms.apply(
        colin.perturbed_head_to_world(3), colin.task("task-1").fiducials + noise
    )


def touch(host, points):
    """Put touches into the scene, and wait until the panel has processed them."""
    host.finish_work()
    host.find("registrationText").text = ""
    setPoints(capturedPointsNode(host.scene), LABELS[: len(points)], points)
    host.wait_until(lambda: host.text("registrationText"), "the touches are registered")


def warnings(host):
    layout = host.find("warningsWidget").layout()
    widgets = [layout.itemAt(index).widget() for index in range(layout.count())]
    return [widget.text for widget in widgets if widget.className() == "QLabel"]


def rows(*order):
    return lambda points: points[list(order)]


def moved(row, offset):
    return lambda points: points + np.outer(np.arange(15) == row, offset)


def onto(row, other):
    return lambda points: np.where((np.arange(15) == row)[:, None], points[other], points)


MENDED = {
    "exchanged": (
        rows(0, 1, 3, 2, *range(4, 15)),
        "Points 3 and 4 seem to be exchanged",
        "Put in order",
    ),
    "reversed": (rows(*range(14, -1, -1)), f"({ALL}) are in reverse order", "Put in order"),
    "begun elsewhere": (rows(*range(1, 15), 0), f"({ALL}) start elsewhere", "Put in order"),
    "one place twice": (onto(9, 4), "Points 5 and 10 of the moving points", "Leave out 10"),
    "one bad touch": (moved(6, [9.0, -6.0, 5.0]), "Point 7 lies", "Leave out 7"),
}


def test_one_click_fixes_a_fault_and_undo_reverts_it(panel, touches):
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


UNMENDED = {
    "mirrored": (
        lambda points: points * [1, 1, -1],
        f"({ALL}) are a mirror image",
        "check the sign",
    ),
    "in meters": (
        lambda points: points / MM_PER_M,
        f"({ALL}) are 998.9 times",
        "must be in millimeters",
    ),
    "on one line": (lambda points: points[0] + ONE_LINE, f"({ALL})", "one line"),
    "too few": (lambda points: points[:2], "", "at least 3"),
}


def test_a_warning_without_a_remedy_names_its_points_and_good_touches_raise_none(panel, touches):
    for case, (change, named, advice) in UNMENDED.items():
        touch(panel, change(touches))
        text = " ".join([*warnings(panel), panel.text("registrationText")])
        assert named in text, case
        assert advice in text, case
    touch(panel, touches)
    assert warnings(panel) == []
    assert panel.find("residualsTable").rowCount == 15
