"""The tour for a real Slicer, unmodified, in the host: every section by its widgets."""

import json
from pathlib import Path

import pytest
import slicer

from rastrainer.slicer.settings import PORT, PROGRAM
from Testing.end_to_end.module.installed_simulator import write_program
from Testing.end_to_end.module.story import FAST
from Testing.free_port import free_port
from Testing.slicer.host.fixtures import *  # noqa: F403 (the fixture `host`)

NOT_IN_THE_TOUR = {
    "setupButton": "the button at the top sets up what is not set up yet",
    "removeSetupButton": "it would remove what is set up",
    "connectToRunningButton": "it needs a Slicer that has crashed",
    "endRunningButton": "it needs a Slicer that has crashed",
    "sampleDataButton": "it needs the Internet",
    "restoreLineButton": "the tour removes no line; the host's tests press it",
    "raiseLineButton": "the tour's procedure has one line; the host's tests press it",
    "placeCheckpointButton": "the tour's procedure has its checkpoints; the host's tests press it",
}

TOUR = Path(__file__).parents[1] / "slicer" / "real" / "tour.py"


@pytest.mark.soak
def test_the_release_tour_succeeds_in_the_host(host, tmp_path):
    program = write_program(tmp_path / "rastrainer", tmp_path / "simulator.pid", FAST)
    slicer.app.settings().setValue(PROGRAM.key, str(program))
    # The usual port may be in use by another test that runs at the same time.
    slicer.app.settings().setValue(PORT.key, free_port())
    words = ("--output", str(tmp_path / "tour"), "--patience", "1200")
    status = host.run_script(TOUR, "--", *words)
    content = json.loads((tmp_path / "tour" / "tour.json").read_text())
    assert len(content["steps"]) > 32
    assert content["unused"] == sorted(NOT_IN_THE_TOUR)
    assert [step["note"] for step in content["steps"] if not step["ok"]] == []
    assert content["errors"] == []
    assert status == 0
    assert len(list((tmp_path / "tour").glob("*.png"))) == len(content["steps"])


def test_a_failing_step_and_an_error_in_the_log_end_slicer_with_an_error(host, tmp_path):
    host.scene.AddNewNodeByClass("vtkMRMLModelNode", "A node of the user's")
    status = host.run_script(
        TOUR, "--output", str(tmp_path / "tour"), "--program", str(tmp_path / "nowhere")
    )
    content = json.loads((tmp_path / "tour" / "tour.json").read_text())
    assert [step["ok"] for step in content["steps"]] == [True, True, False]
    assert "There is no program" in content["errors"][0]
    assert "| Start and connect | NO |" in (tmp_path / "tour" / "tour.md").read_text()
    assert status == 1
