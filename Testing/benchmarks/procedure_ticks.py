"""The ticks of a procedure: while the guide is aligned, and while drill and instrument are fed."""

import gc
import time
from dataclasses import replace

import numpy as np

from rastrainer import transforms
from rastrainer.commands import CommandName, check_arguments
from rastrainer.protocol import Phase, TouchRule
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.state import NEUTRAL_STICKS, Motion, OperatorCommand, OperatorInput
from Testing.benchmarks.row import row

DT = 0.004
SEED = 7
PROCEDURE = "dbs"
TRIAL_ID = "00000000-0000-4000-8000-000000000000"
STAND_OFF_MM = 30.0
STICK_TICKS, FEED_TICKS = 900, 2500
FEED_IN = OperatorInput(translation=(0.0, 0.0, -1.0))


def procedure_rows(setup: SimulationSetup, runs: int) -> list[dict]:
    """Return the rows `tick.align` and `tick.drill` of the default head's procedure.

    The first is of all ticks of the guide's alignment, by the robot itself and by sticks that turn
    and move it at random; the second of all in which drill or instrument is fed. As in the rows of
    touches, a tick's time is the median of the runs, and success the share of those below 4 ms.
    """
    anywhere = replace(
        setup.settings.training, acceptance_radius=10.0, touch_rule=TouchRule.WITHIN_RADIUS
    )
    settings = replace(setup.settings, training=anywhere)
    simulation = Simulation(replace(setup, settings=settings), SEED)
    gc.collect()
    gc.freeze()
    try:
        measured = [_Operation(simulation).times() for _ in range(runs)]
    finally:
        gc.unfreeze()
    return [
        _row(name, [each[part] for each in measured])
        for part, name in enumerate(("tick.align", "tick.drill"))
    ]


def _row(name: str, runs: list[list[float]]) -> dict:
    shortest = min(map(len, runs))
    times = 1e3 * np.array([run[:shortest] for run in runs])
    return row(name, np.median(times, axis=0), "ms", success=float((times < 1e3 * DT).mean()))


class _Operation:
    """One procedure from its start to its abortion, each tick of it timed."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._times: dict[Phase, list[float]] = {phase: [] for phase in Phase}

    def times(self) -> tuple[list[float], list[float]]:
        """Carry it out; return the times in s of the ticks of alignment and of feeding."""
        self._begin()
        random = np.random.default_rng(SEED)
        for _ in range(2):
            self._do(CommandName.ALIGN_GUIDE, standOffMm=STAND_OFF_MM)
            self._until_still()
            for _ in range(STICK_TICKS // 15):
                stick = random.uniform(-1.0, 1.0, 5).tolist()
                for _ in range(15):
                    self._step(OperatorInput(tuple(stick[:3]), tuple(stick[3:])))
            self._do(CommandName.ALIGN_GUIDE, standOffMm=STAND_OFF_MM)
            self._until_still()
            self._do(CommandName.LOCK_GUIDE)
            self._feed()
            self._do(CommandName.START_INSERTION)
            self._feed()
            self._do(CommandName.RELEASE_INSTRUMENT)
        # A registered trial needs no Abort: the next StartTask starts a new one.
        fed = [*self._times[Phase.DRILLING], *self._times[Phase.INSERTING]]
        return self._times[Phase.ALIGNING], fed

    def _begin(self) -> None:
        """Touch and register; the registration is the truth, which a tick does not notice."""
        self._do(
            CommandName.START_TASK, task="task-3", trainee="bench", seed=SEED, procedure=PROCEDURE
        )
        for _ in self._simulation.truth.fiducials_ras:
            self._do(CommandName.CAPTURE)
        self._do(CommandName.REGISTER)
        matrix = transforms.inverse(self._simulation.truth.head_to_world)
        self._do(
            CommandName.USE_REGISTRATION,
            trialId=self._simulation.state.training.trial_id,
            matrix=matrix.ravel().tolist(),
            freMm=0.5,
            expectedTreMm=0.5,
        )
        self._do(CommandName.ACCEPT_REGISTRATION)

    def _step(self, operator_input: OperatorInput) -> None:
        phase = self._simulation.state.training.phase
        begin = time.perf_counter()
        result = self._simulation.step(DT, operator_input)
        self._times[phase].append(time.perf_counter() - begin)
        refused = [answer.message for answer in result.answers if not answer.ok]
        assert not refused, refused

    def _do(self, command: str, **arguments: object) -> None:
        checked = check_arguments(command, arguments)
        if command == CommandName.START_TASK:
            checked["trialId"] = TRIAL_ID
        self._step(OperatorInput(commands=(OperatorCommand(command, checked),)))

    def _until_still(self) -> None:
        while self._simulation.state.motion is not Motion.NONE:
            self._step(NEUTRAL_STICKS)

    def _feed(self) -> None:
        for _ in range(FEED_TICKS):
            self._step(FEED_IN)
