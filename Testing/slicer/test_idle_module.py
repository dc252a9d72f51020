"""A module that has nothing to do, or is not seen, costs Slicer nothing: no paint, no poses."""

import json

import slicer

from rastrainer.igtl.content import String
from rastrainer.protocol import DeviceName
from Testing.slicer.host.activity import ActivityWatch
from Testing.slicer.simulator_double import connect_module

CLOCK = 40
"""Tenths of a second that Qt counts."""
TICKS = CLOCK // 5
"""At most twice a second; a module that polls does so ten times."""


def idle_activity(host):
    host.idle_for(1.0)
    with ActivityWatch() as watch:
        host.wait_until(lambda: watch.clock >= CLOCK, "time passes")
    return watch


def test_idle_nothing_is_written_or_drawn_again_and_behind_another_module_no_timer_runs(host):
    host.open()
    for name in vars(host.widget.ui):
        if name.endswith(("CollapsibleButton", "GroupBox")) and "collapsed" in dir(host.find(name)):
            host.find(name).collapsed = False
    watch = idle_activity(host)
    assert (watch.writes, watch.drawn) == ([], [])
    assert 0 < watch.ticks <= TICKS
    host.leave()
    assert idle_activity(host).ticks == 0
    # Changes are shown at once all the same.
    host.scene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", "Mine")
    host.wait_until(lambda: host.widget.logic.session.restS(False) is None, "it rests again")


def test_connected_nothing_is_written_or_drawn_again_and_a_state_is_shown_without_a_poll(
    fresh_module, simulator
):
    host = fresh_module

    def tell(instruction):
        state = String(json.dumps({"phase": "idle", "instruction": instruction}))
        simulator.send(DeviceName.SIM_STATE, state)
        host.wait_until(lambda: instruction in host.text("trainingText"), "the state arrives")

    connect_module(host, simulator)
    tell("Ask for a trial.")
    watch = idle_activity(host)
    assert (watch.writes, watch.drawn) == ([], [])
    assert watch.ticks <= TICKS
    with ActivityWatch() as watch:
        tell("Now.")
    assert watch.ticks <= watch.clock // 5 + 2


def test_visibility_depends_on_the_layout_and_on_the_module(fresh_module):
    from rastrainer.sections.application import isAnythingVisible

    for layout, is_entered, in_slices, is_seen in (
        ("FourUpView", True, False, True),
        ("FourUpView", False, False, True),
        ("OneUp3DView", False, True, True),
        ("OneUpRedSliceView", False, False, False),
        ("OneUpRedSliceView", False, True, True),
        ("OneUpPlotView", False, True, False),
        ("OneUpPlotView", True, False, True),
    ):
        number = getattr(slicer.vtkMRMLLayoutNode, f"SlicerLayout{layout}")
        slicer.app.layoutManager().setLayout(number)
        assert isAnythingVisible(is_entered, in_slices) is is_seen
        fresh_module.minimize()
        assert not isAnythingVisible(is_entered, in_slices)
        fresh_module.minimize(False)
        assert isAnythingVisible(is_entered, in_slices) is is_seen
