"""A desk at a control loop that ticks as fast as it can."""

from __future__ import annotations

from concurrent.futures import Future

import pytest

from rastrainer_simulator.control_loop import ControlLoop
from rastrainer_simulator.controls.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.flow.desk import Desk
from rastrainer_simulator.flow.preferences import Preferences
from rastrainer_simulator.flow.running_desk import RunningDesk
from rastrainer_simulator.flow.session import Surroundings
from rastrainer_simulator.operator_input import Command, OperatorInput
from rastrainer_simulator.simulation import Simulation
from rastrainer_simulator.state import Answer
from Testing.sdl_virtual_gamepad import VirtualGamepad
from Testing.simulator.flow.trainee import Keys, Pad, Trainee


class Outside:
    """What the desk is told of the process around it."""

    def __init__(self, folder):
        self.has_slicer = False
        self.has_quit = False
        self.settings = []
        self.scenarios = []
        self.loads = []
        self.surroundings = Surroundings(
            config=folder / "config",
            records=folder / "records",
            use_settings=self._use,
            list_scenarios=self._list,
            use_scenario=self._load,
            is_slicer_there=lambda: self.has_slicer,
            quit=lambda: setattr(self, "has_quit", True),
        )

    def _list(self):
        done = Future()
        done.set_result(self.scenarios)
        return done

    def _load(self, name):
        self.loads.append((name, Future()))
        return self.loads[-1][1]

    def _use(self, settings):
        self.settings.append(settings)
        done = Future()
        done.set_result(Answer(0, True))
        return done


@pytest.fixture(scope="session")
def shared(setup):
    return Simulation(setup, 3)


def put_back(simulation):
    """End whatever trial another test has left."""
    start = Command("StartTask", {"task": "task-1", "trainee": "nobody", "mode": "desktop"})
    commands = (Command("Abort"), start, Command("Abort"))
    simulation.step(0.004, OperatorInput(commands=commands))


@pytest.fixture
def outside(tmp_path):
    return Outside(tmp_path)


@pytest.fixture
def loop(shared, tmp_path):
    put_back(shared)
    with ControlLoop(shared, tmp_path / "records", speed=None) as loop:
        yield loop


@pytest.fixture
def desk(loop, outside):
    desk = Desk(loop, outside.surroundings, DEFAULT_BINDINGS, Preferences())
    yield desk
    desk.close()


@pytest.fixture
def trainee(loop, desk):
    """Return a trainee with a keyboard, at the start menu."""
    trainee = Trainee(loop, desk, Keys)
    trainee.until_menu("start")
    yield trainee
    trainee.close()


@pytest.fixture
def running(loop, outside):
    """Return a desk with SDL's gamepads."""
    running = RunningDesk(loop, outside.surroundings, has_gamepad=True)
    yield running
    running.close()


@pytest.fixture
def felt():
    """Return the strengths of the motors at each of SDL's calls."""
    return []


@pytest.fixture
def pilot(loop, running, felt):
    """Return a trainee with a gamepad, at the start menu."""
    gamepad = VirtualGamepad(lambda *strengths: felt.append(strengths))
    gamepad.plug_in()
    pilot = Trainee(loop, running.desk, lambda it: Pad(it, gamepad), running.advance)
    pilot.until_menu("start")
    yield pilot
    pilot.close()
    if gamepad.is_plugged_in:
        gamepad.plug_out()
