"""The window as a separate process, at a real view server: joining, sounds, and rejoining."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from rastrainer_simulator.cli.main import main
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.presentation.messages import Feedback, Hello
from Testing.end_to_end.window_process import BYTES_A_SECOND, times_heard
from Testing.simulator.net.views.served import ServedViews

PATIENCE_S = 300.0
PLAYED = ("touch", "proximity", "contact", "error", "finish", "undo", "touch")
PAUSE_S = 1.0


class Window:
    """`rastrainer window` without a display, whose loudspeaker is a file."""

    def __init__(self, url, key, folder):
        self.heard = folder / "heard.raw"
        self.frames = folder / "frames.jsonl"
        self.process = subprocess.Popen(
            [
                *(
                    sys.executable,
                    "-m",
                    "rastrainer_simulator.cli.main",
                    "window",
                    "--connect",
                    url,
                ),
                *("--size", "320x320", "--frame-log", str(self.frames)),
                *("--log-folder", str(folder / "logs")),
            ],
            env={
                **os.environ,
                "RASTRAINER_VIEW_KEY": key,
                "SDL_VIDEODRIVER": "offscreen",
                "SDL_AUDIODRIVER": "disk",
                "SDL_DISKAUDIOFILE": str(self.heard),
            },
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def wait_for_picture(self):
        give_up = time.monotonic() + PATIENCE_S
        while not self.frames.exists() or not self.frames.read_text():
            assert self.process.poll() is None, self.process.communicate()[0]
            assert time.monotonic() < give_up
            time.sleep(0.02)


@pytest.fixture(scope="module")
def control_loop(setup, tmp_path_factory):
    records = tmp_path_factory.mktemp("records")
    with ControlLoop(Simulation(setup, seed=3), records) as loop:
        yield loop


@pytest.fixture(scope="module")
def session(loop_thread, control_loop, tmp_path_factory):
    """Have a window hear seven events, lose its server, and find it again."""
    folder = tmp_path_factory.mktemp("window")
    served = ServedViews(loop_thread, control_loop)
    key = served.new_key()
    window = Window(served.url, key, folder)
    try:
        window.wait_for_picture()
        joined = [call for call in served.presenter.calls if call[0] == "view_joined"]
        for number, name in enumerate(PLAYED, start=1):
            served.tell(Feedback(number, name, name, 0.8))
            time.sleep(PAUSE_S)
        served.tell(Feedback(len(PLAYED) + 1, "touch", "touch", volume=0.0))
        served.wait_for_call("on_picture", joined[0][1], "", 1.0)
        pictures = [call[2:] for call in served.presenter.calls if call[0] == "on_picture"]
        port = served.port
        served.close()
        again = ServedViews(loop_thread, control_loop, port=port)
        loop_thread.call(again.server.sessions.admit, key)
        joined += _wait_for_join(again)
        _wait_for_last_sound(window)
        again.close()
    finally:
        window.process.send_signal(signal.SIGKILL)
        said = window.process.communicate()[0]
    return {"joined": joined, "said": said, "heard": window.heard, "pictures": pictures}


def _wait_for_last_sound(window):
    """Wait for another second of sound: a window that is late plays the last event only now."""
    give_up, wanted = time.monotonic() + PATIENCE_S, window.heard.stat().st_size + BYTES_A_SECOND
    while window.heard.stat().st_size < wanted:
        assert time.monotonic() < give_up
        time.sleep(0.02)


def _wait_for_join(served):
    give_up = time.monotonic() + PATIENCE_S
    while not (found := [call for call in served.presenter.calls if call[0] == "view_joined"]):
        assert time.monotonic() < give_up
        time.sleep(0.02)
    return found


def test_the_window_joins_as_a_desktop_and_rejoins_after_its_server_was_down(session):
    assert len(session["joined"]) == 2
    for _name, _view, hello in session["joined"]:
        assert isinstance(hello, Hello)
        assert hello.kind == "desktop"


@pytest.mark.skipif(sys.platform != "linux", reason="ALSA is Linux's")
def test_a_computer_without_a_sound_card_is_told_so_in_one_line():
    words = "from rastrainer_simulator.desktop.app import Sounds; Sounds().close()"
    without = {"SDL_AUDIODRIVER": "alsa", "ALSA_CONFIG_PATH": os.devnull}
    done = subprocess.run(
        [sys.executable, "-c", words],
        env={**os.environ, **without},
        capture_output=True,
        text=True,
        check=True,
    )
    (line,) = done.stderr.splitlines()
    assert line.startswith("There will be no sound: ")


def test_the_window_says_once_that_its_picture_is_drawn(session):
    assert session["pictures"] == [("", 0.0), ("", 1.0)]


def test_the_window_prints_no_warnings_or_errors(session):
    lines = session["said"].splitlines()
    assert [line for line in lines if "warning" in line.lower() or "error" in line.lower()] == []


@pytest.mark.parametrize("name", sorted(set(PLAYED)))
def test_each_event_is_heard_exactly_once(session, name):
    assert times_heard(session["heard"], name) == PLAYED.count(name)


@pytest.mark.parametrize(
    ("arguments", "key", "sentence"),
    [
        ([], "", "--code must be the pairing code that the simulator shows."),
        (["--connect", "nowhere"], "k" * 40, "--connect must be an address, such as "),
        (["--size", "12x7"], "k" * 40, "--size must be WIDTHxHEIGHT in pixels"),
        (["--connect", "http://127.0.0.1:1", "--code", "1"], "", "There must be a simulator at "),
    ],
)
def test_wrong_arguments_exit_with_a_one_sentence_error_and_status_2(
    capsys, monkeypatch, arguments, key, sentence
):
    monkeypatch.setenv("RASTRAINER_VIEW_KEY", key)
    assert main(["window", *arguments]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"rastrainer: {sentence}")
    assert len(said.splitlines()) == 1


def test_without_a_display_the_window_exits_with_one_sentence_which_its_log_keeps(tmp_path):
    environment = {**os.environ, "RASTRAINER_VIEW_KEY": "k" * 40, "SDL_VIDEODRIVER": "none-such"}
    command = [sys.executable, "-m", "rastrainer_simulator.cli.main", "window"]
    command += ["--log-folder", str(tmp_path)]
    done = subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=PATIENCE_S, check=False
    )
    assert done.returncode == 2
    assert done.stderr.startswith("rastrainer: No window can be opened on this machine: ")
    assert len(done.stderr.splitlines()) == 1
    (line,) = map(json.loads, (tmp_path / "window.log").read_text().splitlines())
    assert line["message"] == done.stderr.removeprefix("rastrainer: ").rstrip()


@pytest.mark.parametrize(
    "command", [pytest.param("window", marks=pytest.mark.soak), "simulator --desktop"]
)
@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere there always is a display")
def test_without_a_display_nothing_runs_invisibly(tmp_path, command):
    hidden = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER", "SDL_VIDEO_DRIVER")
    environment = {name: value for name, value in os.environ.items() if name not in hidden}
    done = subprocess.run(
        [sys.executable, "-m", "rastrainer_simulator.cli.main", *command.split()],
        env={**environment, "RASTRAINER_VIEW_KEY": "k" * 40, "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert done.returncode == 2
    (sentence,) = done.stderr.splitlines()
    assert "display" in sentence
