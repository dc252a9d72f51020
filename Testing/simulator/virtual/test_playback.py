"""A recorded trial replayed in the simulator's views: as recorded, played and sought."""

import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.journal.entries import AcceptedTouch, PhaseChange, ProximityChange
from rastrainer.journal.folder import journals
from rastrainer.journal.journal_file import read_journal
from rastrainer.journal.recording import read_track
from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.inputs import ControlName, InputDevice
from rastrainer_simulator.presentation.messages import Feedback
from rastrainer_simulator.presentation.screen import Screen
from rastrainer_simulator.record.trial_context import setup_of
from rastrainer_simulator.replay import recorded_trial
from rastrainer_simulator.replay.playback import Playback
from rastrainer_simulator.replay.recorded_trial import RecordedTrial, load_trial
from rastrainer_simulator.replay.replay_presenter import ReplayPresenter, viewer_control
from rastrainer_simulator.virtual.cohort import RECORDS
from Testing.end_to_end.simulator_process import SERVES, paired_key
from Testing.simulator.net.views.served import ViewClient


@pytest.fixture(scope="module")
def journal(played):
    return journals(played / RECORDS)[0]


@pytest.fixture(scope="module")
def track(journal):
    return read_track(journal)


@pytest.fixture(scope="module")
def setup(track):
    return setup_of(track.header)


@pytest.fixture(scope="module")
def trial(track, setup):
    return RecordedTrial(track, setup)


class Viewer:
    """A viewer of a playback."""

    def __init__(self, trial, setup):
        self.playback = Playback(trial, setup)
        self.ended, self.messages, self.tips = [], [], []
        self.presenter = ReplayPresenter(self.playback, "en", lambda: self.ended.append(True))
        self.presenter.updates.add(self.messages.append)
        self.playback.subscribe(lambda result: self.tips.append(result.state.tool_tip_to_world))

    def press(self, code):
        self.presenter.on_key(1, code, True, "")
        self.presenter.on_key(1, code, False, "")

    @property
    def touched(self):
        return len(self.playback.latest.training.touches)


@pytest.fixture
def viewer(trial, setup):
    return Viewer(trial, setup)


def test_at_each_sample_the_arm_is_shown_as_it_was_recorded(track, trial):
    trajectory = track.trajectory
    samples = zip(
        trajectory.times_s, track.q, trajectory.tip_mm, trajectory.clearance_mm, strict=True
    )
    for time_s, q, tip_mm, clearance_mm in samples:
        state = trial.state_at(time_s)
        np.testing.assert_allclose(state.q, q, rtol=0, atol=1e-12)
        np.testing.assert_allclose(1000.0 * state.tool_tip_to_world[:3, 3], tip_mm, atol=1e-6)
        assert 1000.0 * state.clearance == pytest.approx(clearance_mm, abs=1e-9)


def test_touches_phases_and_contact_match_those_of_the_journal(journal, track, trial):
    for event in track.events:
        state, entry = trial.state_at(event.time_s), event.entry
        if isinstance(entry, AcceptedTouch):
            assert [touch.label for touch in state.training.touches][-1] == entry.label
            assert len(state.training.touches) == entry.kept
        elif isinstance(entry, PhaseChange):
            assert state.training.phase is trial_phase_at(track, event.time_s)
        elif isinstance(entry, ProximityChange):
            assert state.proximity is entry.to
    assert {event.entry.kind for event in track.events} >= {"touch", "phase", "proximity"}
    last = trial.state_at(trial.duration_s)
    assert (len(last.training.touches), last.training.phase) == (15, Phase.REGISTERED)
    registered = read_journal(journal).of_kind("registered")[0]
    assert last.elapsed == pytest.approx(registered["record"]["completionTimeS"], abs=0.1)
    np.testing.assert_allclose(
        last.head_to_world[:3, 3] * 1000.0,
        np.reshape(registered["truth"]["headToWorld"], (4, 4))[:3, 3],
    )


def trial_phase_at(track, time_s):
    """Return the phase of the last event up to a time."""
    until = [each.entry for each in track.events if each.time_s <= time_s]
    return [entry.phase for entry in until if isinstance(entry, PhaseChange)][-1]


def test_playback_runs_in_real_time_and_stops_at_its_end(viewer, trial):
    viewer.playback.advance(10.0)
    assert viewer.playback.latest.q == trial.state_at(10.0).q
    viewer.press("Space")
    viewer.playback.advance(10.0)
    assert (viewer.playback.time_s, viewer.presenter.screen.status[-1]) == (10.0, "Paused")
    viewer.press("Space")
    viewer.playback.advance(1e6)
    assert (viewer.touched, viewer.playback.is_playing) == (15, False)
    kinds = [one.kind for one in viewer.messages if isinstance(one, Feedback)]
    assert kinds.count("touch") - kinds.count("undo") == 15
    viewer.press("Space")
    assert (viewer.playback.time_s, viewer.playback.is_playing) == (0.0, True)


def test_playback_can_be_sought_and_viewed_through_both_cameras(viewer):
    viewer.playback.advance(12.0)
    viewer.press("ArrowLeft")
    assert viewer.playback.time_s == 7.0
    viewer.press("ArrowRight")
    assert viewer.playback.time_s == 12.0
    before = viewer.playback.latest.camera
    viewer.press("KeyC")
    assert {before, viewer.playback.latest.camera} == {"close-up", "far"}
    viewer.playback.advance(1.0)
    assert viewer.playback.latest.camera != before
    viewer.presenter.on_pad(1, [], [1.0])
    viewer.presenter.on_pad(1, [], [1.0])
    assert not viewer.playback.is_playing
    viewer.press("Escape")
    assert viewer.ended == [True]


def test_a_stick_that_trembles_while_it_is_pushed_seeks_once(viewer):
    viewer.playback.advance(12.0)
    for pushed in (0.0, 0.7, 0.48, 0.52, 0.48, 0.7):
        viewer.presenter.on_pad(1, [pushed, 0.0, 0.0, 0.0], [0.0] * 17)
    assert viewer.playback.time_s == 17.0


@pytest.mark.parametrize(
    ("device", "name"), [(InputDevice.KEYBOARD, "KeyT"), (InputDevice.GAMEPAD, "x")]
)
def test_an_input_that_was_given_to_the_camera_no_longer_shows_the_worst_touch(device, name):
    rebound = DEFAULT_BINDINGS.rebound(device, ControlName.CAMERA, name)
    assert viewer_control(DEFAULT_BINDINGS, device, name) is ControlName.UP
    assert viewer_control(rebound, device, name) is ControlName.CAMERA


def test_the_worst_touch_is_shown_at_half_speed_up_to_the_touch(viewer, trial):
    label, begin, end = trial.worst
    viewer.press("KeyT")
    assert viewer.presenter.screen.instruction.text.startswith(f"Point {label}, the worst touch")
    before = viewer.touched
    viewer.playback.advance(1.0)
    assert viewer.playback.time_s == pytest.approx(begin + 0.5)
    viewer.playback.advance(2.0 * (end - begin))
    assert (viewer.playback.time_s, viewer.playback.is_playing) == (end, False)
    assert viewer.touched > before
    assert viewer.playback.latest.training.touches[-1].label == label
    assert any(isinstance(one, Screen) for one in viewer.messages)


def test_the_worst_touch_is_shown_in_its_best_view_until_the_camera_changes(viewer):
    label, begin, _end = viewer.playback.trial.worst
    scenario = viewer.playback.setup.scenario
    task = scenario.task(viewer.playback.trial.task)
    in_head = task.fiducials[task.labels.index(label)] / MM_PER_M
    head = viewer.playback.trial.state_at(begin).head_to_world
    fiducial = head[:3, :3] @ in_head + head[:3, 3]

    def off_middle():
        main = viewer.presenter.pictures(viewer.playback.latest).main
        eye, middle = np.array(main.position), np.array(main.focal_point)
        line = (middle - eye) / np.linalg.norm(middle - eye)
        return np.linalg.norm(np.cross(fiducial - eye, line))

    # One thread searches for the views, one after the other; first it is kept busy.
    may_search = threading.Event()
    viewer.presenter._view._best._worker.submit(may_search.wait, 60.0)
    viewer.press("KeyT")
    assert off_middle() > 0.001
    may_search.set()
    give_up = time.monotonic() + 60.0
    while off_middle() > 0.001:
        viewer.playback.advance(0.0)
        time.sleep(0.001)
        assert time.monotonic() < give_up, "no best view"
    viewer.press("KeyC")
    assert off_middle() > 0.001


def test_the_simulator_loads_the_same_trial_in_a_thread_without_changing_the_journal(
    journal, setup, trial
):
    before = journal.read_bytes()
    loaded = load_trial(journal, setup).loaded.result(60)
    assert (loaded.worst, loaded.duration_s) == (trial.worst, trial.duration_s)
    ours, theirs = loaded.state_at(7.0), trial.state_at(7.0)
    assert (ours.q, ours.training) == (theirs.q, theirs.training)
    assert journal.read_bytes() == before


@pytest.mark.parametrize(
    ("header", "setups", "sentence"),
    [
        ({}, {"scenario_sha256": "0" * 64}, "another scenario or robot"),
        ({"seed": None}, {}, "does not tell where the head was"),
    ],
)
def test_a_trial_that_cannot_be_shown_is_reported(track, setup, header, setups, sentence):
    changed = replace(track, header=replace(track.header, **header))
    with pytest.raises(InputError, match=sentence):
        RecordedTrial(changed, replace(setup, **setups))


def test_canceled_loading_ends(journal, setup, monkeypatch):
    started, may_go_on = threading.Event(), threading.Event()

    def read(path, rest):
        started.set()
        may_go_on.wait(60)
        return read_track(path, rest)

    monkeypatch.setattr(recorded_trial, "read_track", read)
    loading = load_trial(journal, setup)
    assert started.wait(60)
    loading.cancel()
    may_go_on.set()
    with pytest.raises(InputError, match="was canceled"):
        loading.loaded.result(60)


def test_the_program_serves_the_replay_to_views_until_escape(journal, loop_thread):
    command = ["replay", str(journal), "--no-window", "--view-port", "0"]
    process = subprocess.Popen(
        [sys.executable, "-m", "rastrainer_simulator.cli.main", *command],
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        line = process.stdout.readline()
        url, code = SERVES.search(line.strip()).groups()
        view = ViewClient(loop_thread, url, paired_key(url, code))
        view.join()
        first = view.next("state")
        messages = view.all_until(
            lambda m: m["type"] == "state" and m["elapsedS"] > first["elapsedS"] + 1.0
        )
        assert messages[-1]["poses"] != first["poses"]
        view.send({"type": "key", "code": "Escape", "isDown": True, "text": ""})
        assert process.wait(60) == 0
        view.__exit__()
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
            process.wait(60)
        process.stdout.close()
