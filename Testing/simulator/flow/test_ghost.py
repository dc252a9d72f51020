"""The ghost: an earlier trial of the same task moves next to the arm, and nothing else changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.journal.recording import read_track
from rastrainer.protocol import FREE, OPEN_PHASES
from rastrainer.study_messages import StudyStep
from rastrainer.trial.scoring import SCORE_VERSION
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.loop.timing import TrialLimits
from rastrainer_simulator.replay.recorded_trial import RecordedTrial
from Testing.simulator.flow.conftest import Outside
from Testing.simulator.flow.test_replay_screen import Place
from Testing.simulator.flow.trainee import PATIENCE_S

NEWEST = {"isAccurate": True, "isUnbiased": True, "isSafe": True, "scoreVersion": SCORE_VERSION}
ACCEPTABLE = {"score": 81.0, "details": NEWEST}
NONE = "No ghost: there is no acceptable trial of this task to show yet."
TOOL = -1


class GhostPlace(Place):
    """A simulator at which P07 has played an acceptable trial of Task 1.

    Attributes:
        best: its journal.
    """

    def __init__(self, loop, presenter, outside):
        super().__init__(loop, presenter, outside)
        self.until_menu("start")
        self.play_and_be_scored(ACCEPTABLE)
        self.best = self.journal

    @property
    def ghost(self):
        return self.presenter.ghost(self.presenter.shown.latest)

    def prefer(self, **changes):
        session = self.presenter._session
        session.prefer(**changes)

    def start_and_load(self, task="task-1", trainee="P07"):
        """Begin a task, and let no time of it pass while the ghost is being loaded."""
        answer = self.submit("StartTask", task=task, trainee=trainee)
        assert answer.ok, answer
        ghost = self.presenter._session.ghost
        self.until(lambda: ghost._trial_id == answer.data["trialId"], "the trial")
        self.until_menu(None)
        loading = ghost._loading
        if loading is not None:
            loading.loaded.result(PATIENCE_S)
        self.step()

    def noted(self):
        """Abort the trial, and return what its journal says of the ghost."""
        journal = self.journal
        assert self.submit("Abort").ok
        self.until(lambda: read_journal(journal).integrity is Integrity.INTACT, "its last line")
        return [entry["ghost"] for entry in read_journal(journal).of_kind("ghost")]


@pytest.fixture(scope="module")
def lab(anywhere, tmp_path_factory):
    outside = Outside(tmp_path_factory.mktemp("ghost"))
    limits = TrialLimits(100.0, 100)
    places = Simulation(anywhere, 3), outside.services.records
    with ControlLoop(*places, speed=None, trial_limits=limits) as loop:
        presenter = outside.presenter(loop)
        lab = GhostPlace(loop, presenter, outside)
        yield lab
        lab.close()
        presenter.close()


@pytest.fixture
def place(lab):
    """The simulator without a trial, before and after."""
    yield lab
    if lab.state.training.phase in OPEN_PHASES:
        assert lab.submit("Abort").ok
    lab.prefer(ghost="off", expert="")
    lab.outside.services.assigned.take_step(StudyStep("P07", FREE))


def on_the_head(head_to_world, tool_to_world):
    return np.linalg.inv(head_to_world) @ tool_to_world


def test_the_ghost_follows_the_recorded_path_on_the_head_of_the_current_trial(place, anywhere):
    recorded = RecordedTrial(read_track(place.best), anywhere)
    place.prefer(ghost="own best")
    place.start_and_load()
    positions = set()
    for elapsed in np.linspace(0.0, recorded.worst[2], 9):
        now, before = replace(place.state, elapsed=elapsed), recorded.state_at(elapsed)
        assert not np.allclose(before.head_to_world, now.head_to_world, atol=1e-4)
        shown = place.presenter.ghost(now)[TOOL]
        np.testing.assert_allclose(
            on_the_head(now.head_to_world, shown),
            on_the_head(before.head_to_world, before.tool_tip_to_world),
            atol=1e-9,
        )
        positions.add(tuple(shown[:3, 3]))
    # The arm rests while the disk keeps a touch, as long as that may take.
    assert len(positions) > 1
    assert place.submit("Pause").ok
    place.until_menu("trial")
    stopped = place.ghost[TOOL]
    place.step(20)
    np.testing.assert_array_equal(place.ghost[TOOL], stopped)


def test_the_journal_records_the_ghost_and_replays_to_the_last_bit(place, capsys):
    place.prefer(ghost="own best")
    place.start_and_load()
    place.hands.push(1.0, 0.0, -1.0, False)
    place.step(30)
    place.hands.push(0.0, 0.0, 0.0, False)
    place.step(2)
    journal = place.journal
    assert place.noted() == ["own best"]
    assert main(["replay", str(journal), "--verify"]) == 0
    assert "equal to the last bit" in capsys.readouterr().out


def test_the_expert_is_the_trainee_named_in_the_settings(place):
    place.prefer(ghost="expert", expert="P07")
    place.start_and_load(trainee="P08")
    place.step(5)
    assert place.ghost is not None
    assert place.noted() == ["expert"]


def test_the_trainee_sees_a_message_if_there_is_no_acceptable_trial(place):
    place.prefer(ghost="own best")
    place.start_and_load("task-2")
    place.until(
        lambda: NONE in [warning.text for warning in place.presenter.screen.warnings], "the reason"
    )
    assert place.ghost is None
    assert place.noted() == []


@pytest.mark.parametrize(("ghost", "noted"), [("", []), ("own best", ["own best"])])
def test_in_a_study_a_ghost_is_shown_only_if_its_protocol_says_so(place, ghost, noted):
    place.prefer(ghost="expert", expert="P07")
    step = StudyStep("P07", "trial", task="task-1", ghost=ghost)
    place.outside.services.assigned.take_step(step)
    place.start_and_load()
    place.step(5)
    assert (place.ghost is not None) is bool(ghost)
    assert place.noted() == noted
