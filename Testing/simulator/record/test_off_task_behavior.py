"""Off-task behavior never helps: waiting and detours cost points."""

import functools

import pytest

from rastrainer.commands import CommandName
from rastrainer.trial.analysis import RevealedTruth, analyze_trial
from rastrainer.trial.scoring import LONG_PAUSE_S
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.record.trial_entries import TrialEntries
from rastrainer_simulator.state import NEUTRAL_STICKS, OperatorCommand, OperatorInput
from rastrainer_simulator.virtual.play import play_virtual_trial
from rastrainer_simulator.virtual.scripted_trainee import Skill

DT = 0.02
BRISK = Skill(speed_mm_s=300.0, gain_per_s=6.0, reaction_s=0.1, dwell_s=0.04)
WAIT_S = LONG_PAUSE_S + 5.0


PAUSE, RESUME = (
    OperatorInput(commands=(OperatorCommand(name, {}),))
    for name in (CommandName.PAUSE, CommandName.RESUME)
)
IDLE = [NEUTRAL_STICKS] * round(WAIT_S / DT)
ROUND_TRIP = [
    OperatorInput(translation=(0.0, 0.0, sign)) for sign in (1.0, -1.0) * 8 for _ in range(150)
]

BESIDE = {"nothing": (), "idle": IDLE, "pause": (PAUSE, *IDLE, RESUME), "detours": ROUND_TRIP}


class Meanwhile:
    """Lets inputs come in between after the third touch, and takes the trial's record."""

    def __init__(self, *inputs):
        self._inputs = list(inputs)
        self._entries = None
        self.record = None

    def __call__(self, simulation, before, operator_input, result):
        if self._entries is None:
            self._entries = TrialEntries.started(simulation, before, result, DT)
        self._take(simulation, operator_input, result)
        while self._inputs and len(simulation.state.training.touches) == 3:
            given = self._inputs.pop(0)
            self._take(simulation, given, simulation.step(DT, given))

    def _take(self, simulation, operator_input, result):
        record = self._entries.add(simulation, operator_input, result)
        self.record = self.record if record is None else record.measured()


@pytest.fixture(scope="module")
def played(setup):
    """Give the analysis of a trial for each behavior next to it, each played once."""
    simulation = Simulation(setup, 5)

    @functools.cache
    def play(beside):
        meanwhile = Meanwhile(*BESIDE[beside])
        play_virtual_trial(simulation, "task-1", 3, BRISK, DT, meanwhile)
        head_to_world = setup.scenario.perturbed_head_to_world(3)
        truth = RevealedTruth(tuple(head_to_world.ravel().tolist()), 0.0)
        return analyze_trial(meanwhile.record, setup.scenario, truth=truth)

    return play


@pytest.mark.soak
def test_waiting_in_a_trial_costs_points(played):
    at_once, idle = played("nothing"), played("idle")
    assert idle.record.completion_time_s > at_once.record.completion_time_s + 0.9 * WAIT_S
    assert idle.score.score < at_once.score.score
    assert idle.record.motion["idle_time_s"] > WAIT_S - 1.0


def test_a_pause_changes_no_score_and_is_reported_beside_it_with_its_length(played):
    at_once, paused = played("nothing"), played("pause")
    assert paused.record.completion_time_s == pytest.approx(
        at_once.record.completion_time_s, abs=2.0
    )
    assert paused.score.score <= at_once.score.score + 1.0
    motion = paused.record.motion
    assert motion["pauses"] == 1
    assert motion["pause_time_s"] == pytest.approx(WAIT_S, abs=3 * DT)
    assert motion["idle_time_s"] < at_once.record.motion["idle_time_s"] + 2.0
    assert any(f"Paused for {WAIT_S:.0f} s" in words for words in paused.feedback.sentences)
    assert not any("Paused" in words for words in at_once.feedback.sentences)


def test_detours_cost_points_and_are_advised_against(played):
    at_once, around = played("nothing"), played("detours")
    direct, detoured = (a.record.motion["path_efficiency"] for a in (at_once, around))
    assert detoured < 0.7 * direct < 0.7
    assert around.score.score < at_once.score.score
    before, after = (
        {advice.topic: advice.gain for advice in analysis.feedback.advice}.get("detours", 0.0)
        for analysis in (at_once, around)
    )
    assert after > before + 1.0
