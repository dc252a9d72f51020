"""A study that is led over OpenIGTLink, as a view of the real simulator shows it to the trainee."""

from __future__ import annotations

import secrets

from rastrainer.igtl.client import Client
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.study.protocol.study_step import StudyStep
from Testing.end_to_end.simulator_process import ViewedSimulator
from Testing.simulator.net.views.served import ViewClient


def go_to(view, item, menu):
    """Choose an item, and return the screen when that menu is open."""
    view.send({"type": "item", "name": item})
    return screen_where(view, lambda screen: screen["menu"]["name"] == menu)


def screen_where(view, is_wanted):
    """Return the next screen with a menu that is as wanted."""
    while True:
        screen = view.next("screen")["screen"]
        if screen.get("menu") and is_wanted(screen):
            return screen


def enabled(screen):
    items = screen["menu"]["items"]
    return [item["name"] for item in items if "task" in item["name"] and item["is_enabled"]]


def test_the_trainees_menu_offers_what_slicer_sends_of_a_study(loop_thread, tmp_path):
    key = secrets.token_hex(32)
    hello = {"protocolVersion": PROTOCOL_VERSION, "client": "Slicer"}
    step = StudyStep("P07", "trial", 3, 19, "task-2", "desktop")
    with (
        ViewedSimulator(tmp_path / "records", key=key) as simulator,
        Client(port=simulator.port) as slicer,
        ViewClient(loop_thread, simulator.url, key) as view,
    ):
        assert slicer.send_command("Hello", hello, timeout=60).ok
        assert slicer.send_command("StudyStep", step.arguments(), timeout=60).ok
        view.join(kind="desktop")
        go_to(view, "train", "introduction")
        go_to(view, "skip", "controls")
        go_to(view, "next", "experiment")
        view.send({"type": "text", "name": "trainee", "value": "P07"})
        screen = screen_where(view, lambda screen: enabled(screen))
        assert enabled(screen) == ["task-2"]
        assert "play Task 2" in screen["menu"]["paragraphs"][0]
        done = StudyStep("P07", "all-done", 19, 19)
        assert slicer.send_command("StudyStep", done.arguments(), timeout=60).ok
        screen = screen_where(view, lambda screen: not enabled(screen))
        assert "All steps of the study are done" in screen["menu"]["paragraphs"][0]
        refused = slicer.send_command("StudyStep", {"trainee": "P07", "kind": "dance"}, timeout=60)
        assert "kind must be one of questionnaire, trial-run" in refused.error
