"""Connected to a real simulator, Slicer renders only while a user sees the robot move."""

import time

import pytest
import slicer

from rastrainer.commands import CommandName
from rastrainer.igtl.client import Client
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.slicer.link.link_status import LinkState
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.slicer.host.fixtures import host, module_widget  # noqa: F401

PAUSE_S = 1.5
"""Longer than a pose or a poll takes: the module looks once a second."""
STROKE_S = 2.0


@pytest.fixture(scope="module")
def simulator(tmp_path_factory):
    records = tmp_path_factory.mktemp("lab") / "records"
    with SimulatorProcess(records, "--no-views") as simulator:
        yield simulator


class Arm:
    def __init__(self, client):
        self._client = client
        self._direction = 1.0
        self._moves_until = 0.0

    def do(self, name, **arguments):
        reply = self._client.send_command(name, arguments, timeout=60)
        assert reply.ok, f"{name}: {reply.error}"

    def move(self):
        """Start moving, up or down, for some time."""
        self.do("Jog", velocityMmS=[0, 0, 20.0 * self._direction], durationS=STROKE_S)
        self._direction = -self._direction
        self._moves_until = time.monotonic() + STROKE_S

    def keep_moving(self):
        """Start moving again once the last move is over."""
        if time.monotonic() > self._moves_until:
            self.move()


@pytest.fixture
def connected(host, module_widget, simulator):  # noqa: F811
    host.type("portSpinBox", str(simulator.port))
    host.press("connectButton")
    link = module_widget.logic.session.link
    host.wait_until(lambda: link.status.state is LinkState.CONNECTED, "it connects")
    return host


@pytest.fixture
def arm(connected, simulator):
    """The arm in a trial that the module knows of, moved by another client of the simulator."""
    with Client(port=simulator.port) as client:
        arm = Arm(client)
        arm.do("Hello", protocolVersion=PROTOCOL_VERSION, client="player")
        arm.do("StartTask", task="task-1", trainee="T-001")
        connected.wait_until(lambda: "running" in connected.text("phaseText"), "the trial runs")
        yield arm
        arm.do("Abort")


def renders_in_a_while(host):  # noqa: F811
    before = host.renders
    host.idle_for(PAUSE_S)
    return host.renders - before


def wait_until_idle(host):  # noqa: F811
    """Wait until all earlier requests are drawn, and nothing more is, however slow the machine."""
    session = host.widget.logic.session
    # When the first is answered, the module has asked for the poses that it wants now; those that
    # the simulator sends at once, at its next tick, come before its answer to the third.
    for _question in range(3):
        answers = []
        session.link.send(CommandName.LIST_TASKS, {}, answers.append, timeoutS=60.0)
        host.wait_until(lambda answers=answers: answers, "the simulator answers")
        assert answers[0].ok
    host.wait_until(
        lambda: renders_in_a_while(host) == 0 and not session.work.isBusy,
        "nothing is drawn any more",
    )


def assert_movements_are_not_drawn(host, arm):  # noqa: F811
    wait_until_idle(host)
    arm.move()
    assert renders_in_a_while(host) == 0


def wait_for_renders(host, arm, count=3):  # noqa: F811
    before = host.renders

    def is_seen():
        arm.keep_moving()
        return host.renders >= before + count

    host.wait_until(is_seen, "the robot visibly moves")


def set_layout(name):
    layout = getattr(slicer.vtkMRMLLayoutNode, f"SlicerLayout{name}")
    slicer.app.layoutManager().setLayout(layout)


def test_a_robot_that_moves_is_rendered_only_in_a_3d_view_that_shows_it(connected, arm):
    assert_movements_are_not_drawn(connected, arm)
    connected.check("robotCheckBox")
    wait_until_idle(connected)
    wait_for_renders(connected, arm)
    connected.check("robotCheckBox", False)
    assert_movements_are_not_drawn(connected, arm)
    connected.check("robotCheckBox")
    connected.leave()
    wait_for_renders(connected, arm)
    set_layout("OneUpRedSliceView")
    assert_movements_are_not_drawn(connected, arm)
    set_layout("FourUpView")
    wait_for_renders(connected, arm)


@pytest.mark.soak
def test_nothing_is_rendered_in_a_minimized_window(connected, arm):
    connected.check("robotCheckBox")
    connected.minimize()
    assert_movements_are_not_drawn(connected, arm)
    connected.minimize(False)
    wait_for_renders(connected, arm)
