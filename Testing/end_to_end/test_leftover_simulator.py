"""A simulator that a crash of Slicer has left behind: the module finds it, joins it or ends it."""

import pytest

from rastrainer.slicer.program.child_process import ChildProcess
from Testing.end_to_end.module.story import Story
from Testing.free_port import free_port
from Testing.slicer.host.host import Host
from Testing.slicer.simulator_double import wait_until


@pytest.fixture
def story(tmp_path):
    """A session about to open the module; a slot that raised fails the test."""
    host = Host(tmp_path / "slicer")
    try:
        yield Story(host, tmp_path)
    finally:
        host.close()
    assert host.errors == []


@pytest.fixture
def left(story):
    """A simulator that another Slicer, now gone, has started."""
    story.write_program()
    words = ["simulator", "--port", str(free_port()), "--records", str(story.records)]
    child = ChildProcess([story.program, *words])
    # It says so after it has written into its folder where it listens.
    said = "computes the robot's kinematics"
    wait_until(lambda: any(said in line for line in child.takeLines()), lambda: None)
    yield child
    child.close()


def test_a_leftover_simulator_is_found_when_another_is_started_and_can_be_joined_and_ended(
    story, request
):
    host = story.host
    story.choose_own_program()
    assert not host.find("runningSimulatorFrame").visible
    left = request.getfixturevalue("left")
    host.press("startSimulatorButton")
    assert "was not started from here is running" in host.text("runningSimulatorText")
    assert host.text("programText") == "No simulator was started from here."
    assert "--records" not in host.find("simulatorLogEdit").plainText
    host.press("connectToRunningButton")
    story.wait_until_connected()
    host.press("endRunningButton")
    host.wait_until(lambda: not host.find("runningSimulatorFrame").visible, "it has ended")
    host.wait_until(left.poll, "its process ends, too")
    assert host.text("stateText") == "Not connected."
    story.start_simulator()
    assert not host.find("runningSimulatorFrame").visible
