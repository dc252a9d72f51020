"""A study that is led over OpenIGTLink, as a view of the real simulator shows it to the trainee."""

from __future__ import annotations

import uuid

import pytest

from rastrainer.igtl.client import Client
from rastrainer.json_records import record_to_json
from rastrainer.number_text import with_units
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.curriculum.standing import standing_in
from rastrainer.study.database.study import Study
from rastrainer.study_messages import Assignment, StudyStep
from rastrainer.trial.trial_row import TrialRow
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.end_to_end.simulator_process import ViewedSimulator
from Testing.end_to_end.study_side import STUDY, StudySide
from Testing.simulator.net.views.served import ViewClient


def go_to(view, item, menu):
    """Choose an item, and return the screen when that menu is open."""
    view.send({"type": "item", "name": item})
    return screen_where(view, lambda screen: screen["menu"]["name"] == menu)


def screen_where(view, is_wanted):
    """Return the next screen with a menu that meets a condition."""
    while True:
        screen = view.next("screen")["screen"]
        if screen.get("menu") and is_wanted(screen):
            return screen


def enabled(screen):
    items = screen["menu"]["items"]
    return [item["name"] for item in items if "task" in item["name"] and item["isEnabled"]]


def trainee(screen):
    return next(item["value"] for item in screen["menu"]["items"] if item["name"] == "trainee")


TWO = Curriculum(
    "c",
    "C",
    (Assignment("one", "task-1"), Assignment("two", "task-2", after=("one",))),
)
PASSED = TrialRow("T-001", "desktop", "task-1", values={"score": 80.0}, acceptable=True)


def curriculum(*trials):
    standing = standing_in(TWO, trials, lambda _version: 70.0)
    return record_to_json(standing.message("P08"))


def states(screen):
    return [item["value"] for item in screen["menu"]["items"] if item["value"]]


def test_the_trainees_menu_offers_what_slicer_sends_of_a_study_and_of_a_curriculum(
    loop_thread, tmp_path
):
    hello = {"protocolVersion": PROTOCOL_VERSION, "client": "Slicer"}
    step = StudyStep("P07", "trial", 3, 19, "task-2", "desktop")
    with (
        ViewedSimulator(tmp_path / "records") as simulator,
        Client(port=simulator.port) as slicer,
        ViewClient(loop_thread, simulator.url, simulator.key) as view,
    ):
        assert slicer.send_command("Hello", hello, timeout=60).ok
        assert slicer.send_command("StudyStep", record_to_json(step), timeout=60).ok
        view.join(kind="desktop")
        go_to(view, "train", "introduction")
        go_to(view, "skip", "controls")
        go_to(view, "next", "experiment")
        view.send({"type": "text", "name": "trainee", "value": "P07"})
        screen = screen_where(view, lambda screen: enabled(screen))
        assert enabled(screen) == ["task-2"]
        assert "play Task 2" in screen["menu"]["paragraphs"][0]
        done = StudyStep("P07", "all-done", 19, 19)
        assert slicer.send_command("StudyStep", record_to_json(done), timeout=60).ok
        screen = screen_where(view, lambda screen: not enabled(screen))
        assert "All steps of the study are done" in screen["menu"]["paragraphs"][0]
        refused = slicer.send_command("StudyStep", {"trainee": "P07", "kind": "dance"}, timeout=60)
        assert "kind must be one of questionnaire, trial-run" in refused.error
        assert slicer.send_command("Curriculum", curriculum(), timeout=60).ok
        view.send({"type": "text", "name": "trainee", "value": "P08"})
        screen_where(view, lambda screen: "0 of 2 reached" in states(screen))
        assert states(go_to(view, "assignments", "assignments")) == [with_units("0 / 1"), "locked"]
        assert slicer.send_command("Curriculum", curriculum(PASSED), timeout=60).ok
        screen = screen_where(view, lambda screen: "reached" in states(screen))
        assert states(screen) == ["reached", with_units("0 / 1")]
        refused = slicer.send_command(
            "Curriculum", {"trainee": "P08", "assignments": [{}]}, timeout=60
        )
        assert 'assignments[0] needs the key "name"' in refused.error
        # The Slicer that comes next may have another study: what this one sent is forgotten.
        slicer.close()
        screen_where(view, lambda screen: screen["menu"]["name"] == "experiment")
        with Client(port=simulator.port) as another:
            assert another.send_command("Hello", hello, timeout=60).ok
            for name in ("P09", "P08"):
                view.send({"type": "text", "name": "trainee", "value": name})
                screen = screen_where(view, lambda screen, name=name: trainee(screen) == name)
            assert "assignments" not in [item["name"] for item in screen["menu"]["items"]]


@pytest.mark.soak
def test_the_module_sends_the_simulator_a_trainees_progress_including_that_from_another_seat(
    loop_thread, tmp_path
):
    path = tmp_path / STUDY
    with Study.open(path) as study:
        study.create_trainee("P08")
        CurriculumStore(study).choose(TWO)
    with (
        ViewedSimulator(tmp_path / "records") as simulator,
        StudySide(tmp_path, simulator.port),
        ViewClient(loop_thread, simulator.url, simulator.key) as view,
    ):
        view.join(kind="desktop")
        go_to(view, "train", "introduction")
        go_to(view, "skip", "controls")
        go_to(view, "next", "experiment")
        view.send({"type": "text", "name": "trainee", "value": "P08"})
        screen_where(view, lambda screen: "0 of 2 reached" in states(screen))
        assert states(go_to(view, "assignments", "assignments")) == [with_units("0 / 1"), "locked"]
        with Study.open(path) as study:
            record = make_record(trialId=str(uuid.uuid4()), trainee="P08")
            study.add_trial(record, score=gentle_score(60.0, 0.2))
        screen = screen_where(view, lambda screen: "reached" in states(screen))
        assert states(screen) == ["reached", with_units("0 / 1")]
