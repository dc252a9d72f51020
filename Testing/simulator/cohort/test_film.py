"""A recorded trial shown again in the simulator's views: the same states, played and sought."""

import os
import re
import secrets
import signal
import subprocess
import sys

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.journal.folder import journals
from rastrainer.journal.journal_reader import read_journal
from rastrainer.journal.recording import Recording
from rastrainer_simulator.cli import main
from rastrainer_simulator.cohort.cohort import RECORDS
from rastrainer_simulator.cohort.play import PlaySettings
from rastrainer_simulator.flow.screen import Screen
from rastrainer_simulator.record.recorded_setup import setup_of
from rastrainer_simulator.replaying.film import make_film
from rastrainer_simulator.replaying.film_making import FilmMaking
from rastrainer_simulator.replaying.replay_desk import ReplayDesk
from rastrainer_simulator.replaying.replay_loop import ReplayLoop
from rastrainer_simulator.view_server.operator_desk import Feedback
from Testing.simulator.view_server.served import ViewClient


@pytest.fixture(scope="module")
def journal(played):
    return journals(played / RECORDS)[0]


@pytest.fixture(scope="module")
def setup(journal):
    return setup_of(read_journal(journal).header)


@pytest.fixture(scope="module")
def film(journal, setup):
    return make_film(read_journal(journal), setup)


class Room:
    """A desk with somebody who watches."""

    def __init__(self, film, setup):
        self.loop = ReplayLoop(film, setup)
        self.ended, self.news, self.tips = [], [], []
        self.desk = ReplayDesk(self.loop, "en", lambda: self.ended.append(True))
        self.desk.subscribe(self.news.append)
        self.loop.subscribe(lambda result: self.tips.append(result.state.tool_tip_to_world))

    def press(self, code):
        self.desk.on_key(1, code, True, "")
        self.desk.on_key(1, code, False, "")

    @property
    def touched(self):
        return len(self.loop.latest.training.touches)


@pytest.fixture
def room(film, setup):
    return Room(film, setup)


def test_the_film_is_the_recorded_trial(journal, film):
    assert film.difference is None
    trajectory = Recording.of(read_journal(journal).entries).trajectory()
    tips = {round(frame.time_s, 6): frame.state.tool_tip_to_world[:3, 3] for frame in film.frames}
    # The film begins with the trial's first tick, at whose end it has lasted that long.
    times = np.round(trajectory.times_s - PlaySettings().step_s, 6).tolist()
    shown = [(tips[t], tip) for t, tip in zip(times, trajectory.tip_mm, strict=True) if t in tips]
    assert len(shown) > 0.9 * len(times)
    for ours, recorded in shown:
        np.testing.assert_allclose(1000.0 * ours, recorded, atol=1e-9)
    assert len(film.frames[-1].state.training.touches) == 15


def test_it_plays_in_its_own_time_and_stops_at_its_end(room, film):
    room.loop.advance(10.0)
    assert room.loop.latest is film.frames[film.frames.number_at(10.0)].state
    room.press("Space")
    room.loop.advance(10.0)
    assert (room.loop.time_s, room.desk.screen.status[-1]) == (10.0, "Paused")
    room.press("Space")
    room.loop.advance(1e6)
    assert (room.touched, room.loop.is_playing) == (15, False)
    kinds = [one.kind for one in room.news if isinstance(one, Feedback)]
    assert kinds.count("touch") - kinds.count("undo") == 15
    room.press("Space")
    assert (room.loop.time_s, room.loop.is_playing) == (0.0, True)


def test_it_is_sought_and_looked_at_through_both_cameras(room):
    room.loop.advance(12.0)
    room.press("ArrowLeft")
    assert room.loop.time_s == 7.0
    room.press("ArrowRight")
    assert room.loop.time_s == 12.0
    before = room.loop.latest.camera
    room.press("KeyC")
    assert {before, room.loop.latest.camera} == {"close-up", "far"}
    room.loop.advance(1.0)
    assert room.loop.latest.camera != before
    room.desk.on_pad(1, [], [1.0])
    room.desk.on_pad(1, [], [1.0])
    assert not room.loop.is_playing
    room.press("Escape")
    assert room.ended == [True]


def test_the_worst_touch_is_shown_at_half_speed_up_to_the_touch(room, film):
    label, begin, end = film.worst
    room.press("KeyT")
    assert room.desk.screen.instruction.text.startswith(f"Point {label}, the worst touch")
    before = room.touched
    room.loop.advance(1.0)
    assert room.loop.time_s == pytest.approx(begin + 0.5)
    room.loop.advance(2.0 * (end - begin))
    assert (room.loop.time_s, room.loop.is_playing) == (end, False)
    assert room.touched - before == 1
    assert room.loop.latest.training.touches[-1].label == label
    assert any(isinstance(one, Screen) for one in room.news)


@pytest.fixture
def make(setup):
    """Return what has films made by a process; what still goes on is ended."""
    begun = []

    def make(journal):
        begun.append(FilmMaking(journal, setup.scenario.folder, None))
        return begun[-1]

    yield make
    for making in begun:
        making.cancel()


def test_a_process_beside_the_simulator_makes_the_same_film_and_tells_how_far_it_is(
    make, journal, film
):
    before = journal.read_bytes()
    making = make(journal)
    made = making.film.result(60)
    assert 0.5 < making.share <= 1.0
    assert (made.worst, made.difference) == (film.worst, None)
    assert [frame.time_s for frame in made.frames] == [frame.time_s for frame in film.frames]
    ours, theirs = made.frames[-1].state, film.frames[-1].state
    assert (ours.q, ours.training) == (theirs.q, theirs.training)
    assert journal.read_bytes() == before


def test_what_cannot_be_filmed_beside_the_simulator_is_one_sentence(make, tmp_path):
    (tmp_path / "no.journal").write_text("nothing")
    with pytest.raises(InputError, match=r"^The trial cannot be shown again: .* journal"):
        make(tmp_path / "no.journal").film.result(60)


def test_a_film_that_nobody_wants_any_more_is_not_made(make, journal):
    making = make(journal)
    making.cancel()
    with pytest.raises(InputError, match="cannot be shown again"):
        making.film.result(60)


def test_the_program_serves_it_to_views_until_escape(journal, tmp_path, loop_thread):
    key = secrets.token_hex(32)
    command = ["replay", str(journal), "--view", "--no-window", "--view-port", "0"]
    process = subprocess.Popen(
        [sys.executable, "-m", "rastrainer_simulator.cli", *command],
        env={**os.environ, "RASTRAINER_VIEW_KEY": key, "XDG_CACHE_HOME": str(tmp_path)},
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        line = process.stdout.readline()
        url = re.search(r"http://\S+?:\d+", line)[0]
        view = ViewClient(loop_thread, url, key)
        view.join()
        first = view.next("state")
        told = view.all_until(
            lambda m: m["type"] == "state" and m["elapsed"] > first["elapsed"] + 1.0
        )
        assert told[-1]["poses"] != first["poses"]
        view.send({"type": "key", "code": "Escape", "isDown": True, "text": ""})
        assert process.wait(60) == 0
        view.__exit__()
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
            process.wait(30)
        process.stdout.close()


def test_what_cannot_be_shown_is_one_sentence(tmp_path, journal, capsys):
    (tmp_path / "no.journal").write_text("nothing")
    assert main(["replay", str(tmp_path / "no.journal"), "--view"]) == 2
    assert "is not a trial's journal" in capsys.readouterr().err
    assert main(["replay", str(journal), "--view", "--view-port", "70000"]) == 2
    assert "--view-port must be" in capsys.readouterr().err
