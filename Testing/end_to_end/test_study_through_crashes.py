"""A whole short study between Slicer's side and the simulator, with a `kill -9` of each in it."""

from __future__ import annotations

import json
import random
import time

import pytest

from rastrainer.scenario.scenario import load_scenario
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.questionnaires import NASA_TLX, SUS
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer_simulator.assets import asset_path
from Testing.end_to_end.simulator_process import ViewedSimulator
from Testing.end_to_end.study_side import RECORDS, STUDY, StudySide
from Testing.end_to_end.surviving_player import Killing, SurvivingPlayer
from Testing.free_port import free_port
from Testing.simulator.net.views.served import ViewClient

COLIN = asset_path("scenarios", "colin27")
SHIPPED = asset_path("studies", "published-protocol.json")
TRAINEE = "P07"
TIMEOUT_S = 240.0
SHORT = {
    "modes": ["desktop"],
    "modeOrder": "fixed",
    "tasks": ["task-1", "task-2"],
    "allows": ["commands", "chosen seed", "repeated seed", "other speed", "pauses", "other view"],
    "trialRunMin": 0.2,
    "breakBetweenModesMin": 0,
    "breakBetweenTasksMin": 0.05,
    "questionnaires": [
        {"name": "nasa-tlx", "when": "before-mode", "modes": []},
        {"name": "sus", "when": "after-mode", "modes": []},
    ],
}


class Lab:
    """The folder of a study, and the processes of simulator and Slicer's side."""

    def __init__(self, folder, thread):
        self.folder, self.port = folder, free_port()
        self._thread = thread
        with Study.open(folder / STUDY) as study:
            study.create_trainee(TRAINEE, True)
            progress = StudyProgress(study)
            changed = json.loads(SHIPPED.read_text()) | SHORT
            progress.set_protocol(StudyProtocol.from_json(changed))
            progress.enroll(TRAINEE)
        self.start_simulator()
        self.slicer = StudySide(folder, self.port)

    def close(self):
        self.slicer.kill()
        self.simulator.kill()

    def start_simulator(self):
        """Start it on the port of the previous one."""
        words = ("--speed", "10", "--port", str(self.port))
        self.simulator = ViewedSimulator(self.folder / RECORDS, *words)
        self.port = self.simulator.port

    def start_slicer(self):
        self.slicer = StudySide(self.folder, self.port)

    def view(self):
        return View(self._thread, self.simulator.url, self.simulator.key)

    def progress(self):
        with Study.open(self.folder / STUDY) as study:
            return StudyProgress(study).progress(TRAINEE)

    def until_next(self, name):
        """Wait until a step comes next in the study's file, or none."""
        give_up = time.monotonic() + TIMEOUT_S
        while (step := self.progress().next_step) is not None and step.name != name:
            assert time.monotonic() < give_up, f"{step.name} comes next, not {name}"
            time.sleep(0.05)
        assert (None if step is None else step.name) == name


class View(ViewClient):
    """The trainee's view, in which they click; it must be read all the time."""

    def __enter__(self):
        self.join(kind="desktop")
        return self

    def choose(self, item, menu):
        self.send({"type": "item", "name": item})
        return self.until(lambda screen: name_of(screen) == menu)

    def enter(self):
        """Go to the experiment menu, and enter the trainee's ID."""
        self.choose("train", "introduction")
        self.choose("skip", "controls")
        self.choose("next", "experiment")
        self.send({"type": "text", "name": "trainee", "value": TRAINEE})

    def until(self, is_wanted):
        while not is_wanted(screen := self.next("screen")["screen"]):
            pass
        return screen

    def until_offered(self, *names):
        """Wait until the trainee's menu offers these steps and no other."""
        self.until(lambda screen: offered(screen) == list(names))

    def answer(self, questionnaire, presses):
        """Answer each item by a number of presses."""
        self.choose("answer", "questionnaire")
        for item in questionnaire.items:
            for _ in range(presses):
                self.send({"type": "item", "name": item.name})
        self.choose("keep", "experiment")


def name_of(screen):
    return screen["menu"]["name"] if screen.get("menu") else None


def offered(screen):
    if name_of(screen) != "experiment":
        return None
    names = ("answer", "trial-run", *(f"task-{number}" for number in range(1, 6)))
    return [i["name"] for i in screen["menu"]["items"] if i["name"] in names and i["isEnabled"]]


@pytest.fixture
def lab(loop_thread, tmp_path):
    lab = Lab(tmp_path, loop_thread)
    yield lab
    lab.close()


@pytest.mark.soak
def test_a_study_is_completed_although_slicer_and_the_simulator_are_killed_during_it(lab):
    player = SurvivingPlayer(load_scenario(COLIN), random.Random(8), TRAINEE)
    with lab.view() as view:
        view.enter()
        view.until_offered("answer")
        lab.slicer.kill()
        view.answer(NASA_TLX, presses=2)
    assert lab.progress().next_step.name == "desktop/before/nasa-tlx"
    lab.start_slicer()
    lab.until_next("desktop/trial-run")

    with lab.view() as view:
        view.until_offered("trial-run")
        view.send({"type": "item", "name": "trial-run"})
        view.until(lambda screen: name_of(screen) == "practice")
        # At ten times the speed, a busy Slicer's side lags behind by seconds of practice.
        lab.until_next("desktop/1/task-1")
        assert offered(view.choose("finish", "experiment")) == ["task-1"]

    assert not player.play(lab.port, Killing(random.Random(8), lab.simulator.kill), 1000)
    lab.start_simulator()
    assert player.play(lab.port, None, 1)
    lab.until_next("desktop/1/task-2/break")
    lab.slicer.kill()
    lab.start_slicer()
    lab.until_next("desktop/1/task-2")

    player.task = "task-2"
    lab.slicer.kill()
    assert player.play(lab.port, None, 1)
    lab.simulator.kill()
    lab.start_simulator()
    with lab.view() as view:
        view.enter()
        view.until_offered("trial-run", "task-1", "task-2", "task-3")
        lab.start_slicer()
        view.until_offered("answer")
        view.answer(SUS, presses=4)
        view.until(lambda screen: "steps of the study are done" in str(screen["menu"]))
    check_study(lab.progress(), player)


def check_study(progress, player):
    """Every step was done once, in order, with the trials played and the answers given."""
    assert [(entry.step, entry.outcome) for entry in progress.entries] == [
        (name, "done")
        for name in (
            "desktop/before/nasa-tlx",
            "desktop/trial-run",
            "desktop/1/task-1",
            "desktop/1/task-2/break",
            "desktop/1/task-2",
            "desktop/after/sus",
        )
    ]
    assert set(progress.counted_trials) == player.registered
    details = [dict(entry.details) for entry in progress.entries]
    assert details[0] == {"answers": [5] * 6}
    assert details[1]["minutes"] >= 0.2
    assert details[3]["minutes"] >= 0.05
    assert details[5] == {"answers": [4] * 10}
