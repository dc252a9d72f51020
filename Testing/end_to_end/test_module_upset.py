"""The scene cleared, nodes deleted, the module left, the simulator killed: nothing is lost."""

import pytest

from Testing.end_to_end.module.story import Story, unfold
from Testing.slicer.host.host import Host

SENTENCES = ("programText", "stateText", "scenarioText", "phaseText", "registrationText")


@pytest.fixture
def story(tmp_path):
    """A session about to start the simulator; a slot that raised fails the test."""
    host = Host(tmp_path / "slicer")
    try:
        begun = Story(host, tmp_path)
        begun.choose_own_program()
        unfold(host, "registrationCollapsibleButton")
        unfold(host, "planCollapsibleButton")
        yield begun
    finally:
        host.close()
    assert host.errors == []


def upset(story, delete_nodes):
    """Do to the scene and the module what users do, then check that all is well."""
    host = story.host
    host.leave()
    host.clear_scene()
    host.idle_for(0.15)
    host.enter()
    story.wait_until_connected()
    if delete_nodes:
        host.delete_nodes()
    host.leave()
    host.idle_for(0.15)
    host.enter()
    host.clear_scene()
    story.wait_until_connected()
    assert host.errors == []
    for name in SENTENCES:
        assert len(host.text(name).split()) > 1, f"{name} says nothing"


@pytest.mark.soak
def test_the_scene_may_be_disrupted_after_every_step(story):
    for step, delete_nodes in (
        (Story.start_simulator, False),
        (Story.create_trainee, False),
        (Story.show_scenario, True),
        (Story.start_task, False),
        (Story.touch_some, True),
        (Story.pause_and_resume, False),
        (Story.touch_the_others, False),
        (Story.register, True),
        (Story.look_at_score, False),
        (Story.export, False),
    ):
        step(story)
        upset(story, delete_nodes)
    assert story.host.find("historyTable").rowCount == 1
    story.delete_trainee()


def test_the_simulator_may_be_killed_and_restarted_during_a_trial(story):
    story.start_simulator()
    story.create_trainee()
    story.start_task()
    story.touch(1, 2)
    story.kill_simulator()
    host = story.host
    host.wait_until(lambda: "no touch is lost" in host.text("phaseText"), "the message")
    story.start_simulator()
    story.resume_task()
    assert host.find("pointsProgressBar").value == 2
