"""Text of a peer, a file or a user is shown unchanged: no HTML, no wider than the dock."""

import json
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

import pytest

from rastrainer.igtl.content import String
from rastrainer.protocol import DeviceName
from rastrainer.widgets.plain_text import LONGEST_TEXT, toolTip
from Testing.slicer.recorded_trial import COLIN27
from Testing.slicer.simulator_double import connect_module

MODULE = Path(__file__).parents[2] / "RASTrainer"
DOCK_WIDTH = 472
HTML = "<b>bold</b><img src='http://192.0.2.1/x.png'>&lt;"
LONG = "W" * 3000
HOSTILE = f"{HTML}{LONG}"
PLAIN, RICH = 0, 1
"""`Qt::PlainText` and `Qt::RichText`."""


@pytest.fixture
def open_module(fresh_module):
    """The module with every section and group open."""
    for widget in widgets():
        if "Collapsible" in widget.get("class"):
            fresh_module.find(widget.get("name")).collapsed = False
    fresh_module.process_events()
    return fresh_module


def widgets():
    for path in sorted((MODULE / "Resources" / "UI").glob("*.ui")):
        yield from ElementTree.parse(path).iter("widget")


def shows_verbatim(host, *names, text=HOSTILE):
    """Check that labels show a text, or its beginning, literally, and do not widen the dock."""
    for name in names:
        label = host.find(name)
        shown = label.text.replace("\u200b", "")
        assert label.textFormat == PLAIN, name
        assert text[:100] in shown, name
        assert len(shown) <= LONGEST_TEXT, name
    assert host.minimum_width() <= DOCK_WIDTH


def test_each_label_shows_its_text_as_it_is_and_does_not_grow_with_a_long_word(open_module):
    host, before = open_module, open_module.minimum_width()
    from rastrainer.widgets.controls import setText

    named = {widget.get("name") for widget in widgets() if widget.get("class") == "QLabel"}
    lights = {name for name in named if name.endswith("Light")}
    assert {host.find(name).textFormat for name in lights} == {RICH}
    assert {host.find(name).textFormat for name in named - lights} == {PLAIN}
    names = [name for name in named if name.endswith("Text")]
    for name in names:
        setText(host.find(name), HOSTILE)
    shows_verbatim(host, *names)
    assert host.minimum_width() == before


def test_the_state_of_the_trial_and_a_question_about_its_trainee(open_module, simulator):
    host = open_module
    connect_module(host, simulator)
    state = dict.fromkeys(("instruction", "trainee", "task", "phase", "nextPoint"), HOSTILE)
    state |= {"trialId": "", "mode": HOSTILE, "proximity": HOSTILE}
    simulator.send(DeviceName.SIM_STATE, String(json.dumps(state)))
    host.wait_until(lambda: host.text("trainingText"), "the instruction is shown")
    host.wait_until(lambda: "bold" in host.text("phaseText"), "the phase is shown")
    names = ("trainingText", "instructionText", "phaseText", "nextPointText", "clearanceText")
    shows_verbatim(host, *names)
    shows_verbatim(host, "trialText", text=HTML)
    state = {"trialId": "", "phase": "running", "trainee": HTML, "task": "task-1"}
    simulator.send(DeviceName.SIM_STATE, String(json.dumps(state)))
    host.wait_until(lambda: host.find("abortButton").enabled, "a trial runs")
    host.answer("Abort the trial", "No")
    host.press("abortButton")
    assert "&lt;b&gt;bold" in host.messages[-1].text


def test_names_of_a_host_a_node_and_a_task(open_module, tmp_path):
    host = open_module
    host.find("hostLineEdit").text = HTML
    host.press("probeButton")
    shows_verbatim(host, "stateText", text=HTML)
    model = host.scene.AddNewNodeByClass("vtkMRMLModelNode", HOSTILE)
    host.choose("headModelComboBox", model)
    host.press("useHeadButton")
    host.wait_until(
        lambda: host.messages or "bold" in host.text("otherHeadText"), "the error is shown"
    )
    assert host.minimum_width() <= DOCK_WIDTH
    host.answer("Save the scenario", str(tmp_path / "copy.zip"))
    host.press("exportScenarioButton")
    assert host.minimum_width() <= DOCK_WIDTH
    task = replace(COLIN27.task("task-1"), title=HOSTILE)
    host.widget.logic.session.chooseTask(task, COLIN27)
    assert host.text("startTaskButton").startswith("Start <b>bold</b>")
    assert len(host.text("startTaskButton")) < 80
    assert host.minimum_width() <= DOCK_WIDTH


def test_a_tooltip_is_never_interpreted_as_html():
    assert toolTip("<b>bold</b>") == "<qt>&lt;b&gt;bold&lt;/b&gt;</qt>"
    assert toolTip("&lt;") == "<qt>&amp;lt;</qt>"
    assert len(toolTip(HTML * 1000)) < 40_000
