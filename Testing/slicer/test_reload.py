"""Reload leaves nothing of the module behind but its new widget: no object, observer or timer."""

import gc
import threading
from collections import Counter

import pytest
from PySide6 import QtWidgets

from Testing.slicer.test_images_in_module import wait_for_images

KEPT = (
    "RASTrainer.RASTrainerWidget",
    "rastrainer.sections.panel_stack.PanelStack",
    "rastrainer.sections.score_panel.ScorePanel",
    "rastrainer.slicer.link.link.Link",
    "rastrainer.sections.module_session.ModuleSession",
)


def objects(host):
    """Count our objects."""
    host.process_events()
    gc.collect()
    named = Counter()
    # A module that is reloaded makes its classes anew, with the same names.
    for kind, count in Counter(map(type, gc.get_objects())).items():
        named[f"{kind.__module__}.{kind.__name__}"] += count
    return {name: named[name] for name in KEPT}


def living(host):
    """Count what must not increase: our objects, observers of the scene, nodes, widgets."""
    for _round in range(3):
        counts = objects(host)
    nodes = [host.scene.GetNthNode(index) for index in range(host.scene.GetNumberOfNodes())]
    counts["observers"] = sum(str(one).count("vtkObserver (") for one in (host.scene, *nodes))
    counts["nodes"] = len(nodes)
    counts["widgets"] = len(QtWidgets.QApplication.allWidgets())
    return counts


def settled(host, before, threads):
    """Return the objects that live once all background work and its threads have ended.

    `before` lived before the module was opened, and so did `threads` threads of earlier tests.
    """

    def is_one():
        now = objects(host)
        return all(now[name] - before[name] == 1 for name in KEPT)

    host.wait_until(is_one, "only one module lives")
    host.wait_until(lambda: threading.active_count() <= threads, "its threads have ended")
    return living(host)


@pytest.fixture
def used(host):
    """Returns a function that uses the module a little."""

    def use():
        host.open()
        host.press("showScenarioButton")
        wait_for_images(host)
        host.press("createTraineeButton")
        host.press("placeTargetButton")
        host.place(10.0, 20.0, 30.0)
        host.type("hostLineEdit", "127.0.0.1")
        host.type("portSpinBox", "1")
        host.press("connectButton")
        host.idle_for(0.2)

    return use


def test_reloading_the_module_repeatedly_leaves_one_that_works_and_nothing_else(host, used):
    before, threads = living(host), threading.active_count()
    used()
    former = host.widget
    host.reload()
    assert host.widget is not former
    assert not former._timer.isActive()
    del former
    once = settled(host, before, threads)
    used()
    host.reload()
    again = settled(host, before, threads)
    assert again == once
    assert {name: again[name] - before[name] for name in KEPT} == dict.fromkeys(KEPT, 1)
