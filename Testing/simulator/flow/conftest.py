"""A presenter at a control loop that ticks as fast as it can."""

from __future__ import annotations

import itertools
from concurrent.futures import Future
from unittest import mock

import pytest

from rastrainer.journal.entries import AT_ZERO
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.flow.flow_presenter import FlowPresenter
from rastrainer_simulator.flow.running_presenter import RunningPresenter
from rastrainer_simulator.flow.session.preferences import Preferences
from rastrainer_simulator.flow.session.session import FlowServices
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.ops import instructor_pin
from rastrainer_simulator.ops.instructor_pin import InstructorPin
from rastrainer_simulator.state import Answer, OperatorCommand, OperatorInput
from rastrainer_simulator.viewpoint.best_view import TouchViews
from Testing.sdl_virtual_gamepad import VirtualGamepad
from Testing.simulator.at_once import at_once
from Testing.simulator.flow.trainee import RATE_HZ, Keys, Pad, Trainee
from Testing.without_tutorial import WITHOUT_TUTORIAL, skip_tutorial


@pytest.fixture(scope="session", autouse=True)
def _known_marks():
    """Compute once where the numbers of a task are on the skin, not again for each presenter."""
    known, on_skin = {}, TouchViews.on_skin

    def kept(views, task):
        key = views._head.vertices.tobytes(), task.fiducials.tobytes()
        if key not in known:
            known[key] = on_skin(views, task)
        return known[key]

    with mock.patch.object(TouchViews, "on_skin", kept):
        yield


@pytest.fixture(scope="module", autouse=True)
def _cheap_pins():
    """Make the hash of a PIN cheap: the cost of guessing one is not tested here."""
    with mock.patch.dict(instructor_pin._COST, n=2):
        yield


@pytest.fixture(scope="module", autouse=True)
def _at_once():
    with at_once():
        yield


class Outside:
    """The process around the presenter, as the presenter knows it."""

    def __init__(self, folder):
        self.has_slicer = False
        self.has_quit = False
        self.settings = []
        self.scenarios = []
        self.loads = []
        self.now = 0.0
        self.pin = InstructorPin(folder / "config", lambda: self.now)
        self.services = FlowServices(
            config=folder / "config",
            records=folder / "records",
            use_settings=self._use,
            list_scenarios=self._list,
            use_scenario=self._load,
            is_slicer_connected=lambda: self.has_slicer,
            quit=lambda: setattr(self, "has_quit", True),
            draw_seed=itertools.count(7).__next__,
            pin=self.pin,
        )

    def presenter(self, loop, **preferences):
        return FlowPresenter(loop, self.services, DEFAULT_BINDINGS, Preferences(**preferences))

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
    """End any trial that another test has left, and have heads lie as if there had been none."""
    start = {"task": "task-1", "trainee": "nobody", "mode": "desktop", "seed": 3}
    commands = (OperatorCommand("Abort"), OperatorCommand("StartTask", start))
    simulation.step(0.004, OperatorInput(commands=(*commands, OperatorCommand("Abort"))))
    simulation._training._number = 0
    simulation.restart_from(AT_ZERO)


@pytest.fixture
def outside(tmp_path):
    return Outside(tmp_path)


@pytest.fixture
def loop(shared, tmp_path):
    put_back(shared)
    with ControlLoop(shared, tmp_path / "records", rate_hz=RATE_HZ, speed=None) as loop:
        yield loop


@pytest.fixture
def presenter(loop, outside):
    presenter = outside.presenter(loop, **WITHOUT_TUTORIAL)
    yield presenter
    presenter.close()


@pytest.fixture
def trainee(loop, presenter):
    """Return a trainee with a keyboard, at the start menu."""
    trainee = Trainee(loop, presenter, Keys)
    trainee.until_menu("start")
    yield trainee
    trainee.close()


@pytest.fixture
def running(loop, outside):
    """Return a presenter with SDL's gamepads."""
    skip_tutorial(outside.services.config)
    running = RunningPresenter(loop, outside.services, has_gamepad=True)
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
    pilot = Trainee(loop, running.presenter, lambda it: Pad(it, gamepad), running.advance)
    pilot.until_menu("start")
    yield pilot
    pilot.close()
    if gamepad.is_plugged_in:
        gamepad.unplug()
