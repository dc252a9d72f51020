"""The simulator's window: its page in a browser without bars and tabs, on a display in memory."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from Testing.end_to_end.simulator_process import SERVES, SimulatorProcess, paired_key
from Testing.end_to_end.stream_trainee import WatchingView
from Testing.end_to_end.virtual_display import VirtualDisplay, VirtualKeyboard
from Testing.end_to_end.window_process import wait_until
from Testing.running_process import runs, started_by
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import ViewClient

SIZE = (1280, 720)


class Desk:
    """A simulator with its window, a keyboard, and a view that watches."""

    def __init__(self, folder: Path, display: VirtualDisplay, thread: LoopThread) -> None:
        self.home = folder / "home"
        self.home.mkdir(parents=True, exist_ok=True)
        environment = {**os.environ, "HOME": str(self.home), "DISPLAY": display.name}
        options = ("--view-port", "0", "--no-gamepad", "--desktop")
        self.simulator = SimulatorProcess(folder / "records", *options, env=environment)
        self.url, self.code = SERVES.search(self.simulator.next_line()).groups()
        self.keyboard = VirtualKeyboard(display)
        key = paired_key(self.url, self.code)
        self.view = WatchingView(ViewClient(thread, self.url, key))

    def open_menu(self) -> None:
        """Press Enter in the window until the first menu has led to another."""
        wait_until(lambda: self.view.screen.menu is not None, "the first menu")
        first = self.view.screen.menu.name

        def is_other() -> bool:
            self.keyboard.tap("Enter")
            return self.view.screen.menu.name != first

        wait_until(is_other, "the menu after Enter")

    def close_window(self) -> None:
        self.keyboard.hold("ControlLeft", True)
        self.keyboard.tap("KeyW")
        self.keyboard.hold("ControlLeft", False)

    @property
    def processes(self) -> list[int]:
        """The processes of the window."""
        return started_by(self.simulator.pid)

    @property
    def profiles(self) -> list[Path]:
        """Files that the windows of this user have kept."""
        return list((self.home / "RASTrainer" / "window").iterdir())


@pytest.fixture
def desk(tmp_path):
    with VirtualDisplay(SIZE) as display, LoopThread() as thread:
        desk = Desk(tmp_path, display, thread)
        with desk.simulator:
            yield desk


def test_keys_pressed_in_the_window_operate_and_closing_it_ends_the_simulator(desk):
    desk.open_menu()
    window = desk.processes
    for process in window:
        command = Path("/proc", str(process), "cmdline").read_bytes()
        assert desk.code.encode() not in command, "others can read the pairing code"
    (profile,) = desk.profiles
    assert profile.stat().st_mode & 0o077 == 0
    desk.close_window()
    status, _errors = desk.simulator.wait()
    assert status == 0
    wait_until(lambda: not any(map(runs, window)), "the end of the window's processes")
    assert desk.profiles == []


def test_a_killed_window_leaves_the_simulator_with_a_sentence_how_to_come_back(desk):
    desk.open_menu()
    assert "computes the robot's kinematics by" in desk.simulator.next_line()
    os.kill(desk.processes[0], signal.SIGKILL)
    line = desk.simulator.next_line()
    assert f"open {desk.url} in a browser, and type the pairing code {desk.code}" in line
    assert desk.simulator.stop()[0] == 0
    assert desk.profiles == []


def test_without_a_browser_the_simulator_says_what_to_do(tmp_path):
    environment = {**os.environ, "HOME": str(tmp_path), "DISPLAY": ":none", "PATH": "/none"}
    options = ("--view-port", "0", "--no-gamepad", "--desktop")
    with SimulatorProcess(tmp_path / "records", *options, env=environment) as simulator:
        code = SERVES.search(simulator.next_line())[2]
        lines = [simulator.next_line(), simulator.next_line()]
        assert any("there is no Chrome, Chromium, Edge" in line for line in lines)
        assert any(code in line for line in lines)
        assert simulator.stop()[0] == 0
