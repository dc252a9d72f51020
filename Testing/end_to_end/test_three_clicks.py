"""Three clicks lead from an empty Slicer to a running trial, with the real simulator's process."""

import slicer

from rastrainer.slicer.settings import PORT
from Testing.end_to_end.module.installed_simulator import bundled_package
from Testing.end_to_end.module.story import FAST
from Testing.free_port import free_port
from Testing.slicer.host.fixtures import *  # noqa: F403 (the fixture `host`)


def press_next(host, title, until):
    """Press the button at the top, which says `title`, and wait until it says something else."""
    assert host.text("nextStepButton") == title
    host.press("nextStepButton")
    host.wait_until(lambda: host.text("nextStepButton") == until, f"the button says {until}")


def open_sections(host):
    names = ("setup", "simulator", "trainees", "scenario", "newScenario", "study", "training")
    names += ("registration", "plan", "score")
    return [name for name in names if not host.find(f"{name}CollapsibleButton").collapsed]


def test_three_clicks_lead_from_an_empty_slicer_over_the_set_up_to_a_running_trial(host, tmp_path):
    # The usual port may be in use by another test that runs at the same time.
    slicer.app.settings().setValue(PORT.key, free_port())
    setup = host.open().logic.session.simulator.setup
    options = (*FAST, "--records", str(tmp_path / "trials"))
    setup.package = bundled_package(tmp_path / "module", tmp_path / "simulator.pid", options)
    host.answer("not set up on this computer yet", "Cancel")
    host.press("nextStepButton")
    assert host.text("nextStepButton") == "Start and connect"
    host.answer("not set up on this computer yet", "Ok")
    press_next(host, "Start and connect", until="New trainee")
    assert open_sections(host) == ["trainees"]
    press_next(host, "New trainee", until="Start the trial run")
    assert open_sections(host) == ["training"]
    press_next(host, "Start the trial run", until="Pause")
    assert host.clicks == 4 * ["nextStepButton"], "one was canceled"
    host.wait_until(lambda: "running" in host.text("phaseText"), "it runs")
    names, now = ("linkText", "nowTraineeText", "nowTaskText"), ["Connected", "T001", "Trial run"]
    host.wait_until(lambda: [host.text(name) for name in names] == now, "the panel follows")
