"""A recorded trial replayed in the simulator's views: as recorded, played and sought."""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.journal.entries import AcceptedTouch, PhaseChange, ProximityChange
from rastrainer.journal.folder import journals
from rastrainer.journal.journal_file import read_journal
from rastrainer.journal.recording import read_track
from rastrainer.protocol import Phase
from rastrainer_simulator.presentation.messages import Feedback
from rastrainer_simulator.record.trial_context import setup_of
from rastrainer_simulator.replay.playback import Playback
from rastrainer_simulator.replay.recorded_trial import RecordedTrial
from rastrainer_simulator.replay.replay_presenter import ReplayPresenter
from rastrainer_simulator.virtual.cohort import RECORDS


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


def test_a_trial_that_cannot_be_shown_is_reported(track, setup):
    with pytest.raises(InputError, match="another scenario or robot"):
        RecordedTrial(track, replace(setup, scenario_sha256="0" * 64))
    with pytest.raises(InputError, match="does not tell where the head was"):
        RecordedTrial(replace(track, header=replace(track.header, seed=None)), setup)


def test_the_program_serves_the_replay_to_views_until_escape(journal, serving):
    process, _lines, view = serving("replay", journal)
    first = view.next("state")
    messages = view.all_until(
        lambda m: m["type"] == "state" and m["elapsedS"] > first["elapsedS"] + 1.0
    )
    assert messages[-1]["poses"] != first["poses"]
    view.send({"type": "key", "code": "Escape", "isDown": True, "text": ""})
    assert process.wait(60) == 0
