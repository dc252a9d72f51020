"""The panels put into words what the logic tells; the widgets here are the plainest stand-ins."""

import uuid
from types import SimpleNamespace

import numpy as np
import pytest

from rastrainer.igtl.content import Status, String
from rastrainer.panels.connection_panel import ConnectionPanel
from rastrainer.panels.last_trial_panel import LastTrialPanel
from rastrainer.protocol import PROTOCOL_VERSION, Device
from rastrainer.slicer.headless_kit import headlessKit
from rastrainer.slicer.link import Link
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.trial_desk import ScoredTrial
from rastrainer.trial_analysis import analyze_trial
from rastrainer.trial_record import TrialRecord
from rastrainer.trial_results import RevealedTruth
from Testing.slicer.simulator_double import wait_until


class Widget:
    def __init__(self, **properties):
        self.text, self.toolTip, self.enabled = "", "", True
        self.slots = {}
        self.__dict__.update(properties)

    def connect(self, signal, slot):
        self.slots[signal] = slot

    def click(self):
        self.slots["clicked()"]()


@pytest.fixture
def ui(simulator):
    names = "stateText remedyText trainingText connectButton probeButton trialText timeText"
    names += " freText expectedTreText trueTreText scoreText warningsText"
    widgets = {name: Widget() for name in names.split()}
    widgets["hostLineEdit"] = Widget(text="127.0.0.1")
    widgets["portSpinBox"] = Widget(value=simulator.port)
    return SimpleNamespace(**widgets)


@pytest.fixture
def link(scene):
    link = Link(scene, headlessKit)
    yield link
    link.disconnect()


def run(link, condition):
    def process():
        link.connector.PeriodicProcess()
        link.process()

    wait_until(condition, process)


def test_one_button_connects_and_disconnects(ui, link, simulator):
    panel = ConnectionPanel(ui, link)
    assert (ui.connectButton.text, ui.stateText.text) == ("Connect", "Not connected.")
    ui.connectButton.click()
    run(link, lambda: simulator.commands)
    simulator.send(Device.SIM_SERVER, Status(Status.OK, subcode=PROTOCOL_VERSION))
    simulator.send(Device.SIM_STATE, String('{"instruction": "Touch point 3."}'))
    run(link, lambda: ui.trainingText.text == "Touch point 3.")
    run(link, lambda: ui.stateText.text.startswith("Connected to the simulator"))
    assert ui.connectButton.text == "Disconnect"
    assert not ui.hostLineEdit.enabled
    assert "Disconnect first" in ui.probeButton.toolTip
    ui.connectButton.click()
    assert (ui.connectButton.text, ui.trainingText.text) == ("Connect", "")
    assert ui.hostLineEdit.enabled
    panel.close()


def test_a_closed_panel_hears_nothing_more(ui, link):
    ConnectionPanel(ui, link).close()
    ui.stateText.text = "mine"
    link.connectTo(port=ui.portSpinBox.value)
    assert ui.stateText.text == "mine"


def test_the_last_trial_is_shown_with_units(ui, scenario, make_record):
    desk = SimpleNamespace(trialScored=Signal(), problemFound=Signal())
    panel = LastTrialPanel(ui, desk)
    record = TrialRecord.from_json(make_record(str(uuid.UUID(int=1))))
    analysis = analyze_trial(record, scenario)
    desk.trialScored.emit(ScoredTrial(analysis, RevealedTruth(tuple(np.eye(4).ravel()), 0.4)))
    assert ui.trialText.text == "T-001, task-1, desktop"
    assert ui.timeText.text == "90.0 s"
    assert ui.freText.text == f"{analysis.rigid.fre_mm:.2f} mm"
    assert ui.expectedTreText.text.endswith(" mm)")
    assert ui.trueTreText.text == "0.40 mm"
    desk.problemFound.emit("The disk is full.")
    assert (ui.trialText.text, ui.freText.text) == ("The disk is full.", "")
    panel.close()
