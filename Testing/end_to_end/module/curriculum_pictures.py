"""Make the pictures of a curriculum: `python -m Testing.end_to_end.module.curriculum_pictures`."""

from __future__ import annotations

import json
import tempfile
import uuid
from dataclasses import replace
from pathlib import Path

from playwright.sync_api import sync_playwright

from rastrainer.igtl.client import Client
from rastrainer.json_records import record_to_json
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.database.study import Study
from rastrainer.study_messages import CurriculumMessage
from rastrainer_simulator.assets import asset_path
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.end_to_end.simulator_process import ViewedSimulator
from Testing.pictures import keep_picture
from Testing.slicer.host.host import Host
from Testing.web.chromium import launch, open_page

FOLDER = Path(__file__).parents[3] / "docs" / "pictures"
SIZE = {"width": 1280, "height": 720}
BY_SURFACE = "by surface"
PLAYED = {
    "T001": [("task-1", 70)] * 2
    + [("task-2", 130), ("task-2", 60), ("task-3", 90), (BY_SURFACE, 120)],
    "T002": [("task-1", 160), ("task-1", 80)],
    "T003": [(f"task-{task}", 70) for task in (1, 1, 2, 2, 3, 3, 3)],
}
"""Tasks and completion times, s, of each trainee."""


def play(path: Path) -> None:
    """Store scored trials of some trainees."""
    with Study.open(path) as study:
        for name, trials in PLAYED.items():
            for task, seconds in trials:
                record = make_record(trialId=str(uuid.uuid4()), trainee=name, task=task)
                score = gentle_score(seconds, 0.25)
                if task == BY_SURFACE:
                    record["task"] = "task-3"
                    score = replace(score, version=f"{score.version}-surface")
                study.add_trial(record, score=score)


def keep_panel(folder: Path) -> CurriculumMessage:
    """Save a picture of the module's section; return its message about the first trainee."""
    host = Host(folder)
    host.open()
    path = Path(host.find("studyPathLineEdit").currentPath)
    play(path)
    host.widget.logic.session.trainees.changed.emit()
    for name in ("trainees", "study", "curriculum"):
        host.find(f"{name}CollapsibleButton").collapsed = False
    host.process_events()
    host.type("curriculumPathLineEdit", str(asset_path("studies", "example-curriculum.json")))
    host.press("everybodyCheckBox")
    host.press("setCurriculumButton")
    host.choose("traineeComboBox", "T001")
    for name in ("trainees", "simulator", "setup", "scenario"):
        host.find(f"{name}CollapsibleButton").collapsed = True
    host.idle_for(1.0)
    picture = FOLDER / "curriculum-in-slicer.png"
    host.find("curriculumCollapsibleButton").grab().save(str(picture))
    keep_picture(picture, picture.with_suffix(".webp"))
    with Study.open_for_reading(path) as study:
        message = CurriculumStore(study).standing("T001").message("T001")
    host.close()
    return message


def keep_seat(folder: Path, message: CurriculumMessage) -> None:
    """Save a picture of a simulator's page that shows this curriculum."""
    config = folder / "records-config"
    config.mkdir()
    (config / "preferences.json").write_text(json.dumps({"order": "any"}))
    hello = {"protocolVersion": PROTOCOL_VERSION, "client": "Slicer"}
    with (
        sync_playwright() as playwright,
        ViewedSimulator(folder / "records") as simulator,
        Client(port=simulator.port) as slicer,
    ):
        slicer.send_command("Hello", hello, timeout=60)
        slicer.send_command("Curriculum", record_to_json(message), timeout=60)
        browser = launch(playwright)
        page = open_page(browser, simulator.url, simulator.code, size=SIZE)
        for item, menu in (("train", "introduction"), ("skip", "controls"), ("next", "experiment")):
            page.click(f"[data-name='{item}']")
            page.wait_for_selector(f"body[data-menu='{menu}']")
        page.fill("[data-name='trainee'] input", message.trainee)
        page.click("[data-name='assignments']")
        page.wait_for_selector("body[data-menu='assignments']")
        page.evaluate("page.stage.setQuality('high'); frames_(4)")
        keep_picture(page.screenshot(), FOLDER / "assignments.webp")
        browser.close()


def main() -> None:
    """Make both."""
    with tempfile.TemporaryDirectory() as folder:
        keep_seat(Path(folder), keep_panel(Path(folder)))


if __name__ == "__main__":
    main()
