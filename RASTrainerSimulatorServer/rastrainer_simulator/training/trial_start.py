"""How a trial starts: its ID and seed, its task, its head as it truly lies, and its first state."""

from __future__ import annotations

import hashlib
import uuid
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rastrainer.head.skin_shift import SkinShift
from rastrainer.protocol import Phase
from rastrainer.scenario.method_task import TRACED_METHODS, method_of, task_by_method
from rastrainer_simulator.ops.texts.texts import Texts
from rastrainer_simulator.procedure_state import ProcedureState
from rastrainer_simulator.registration_state import TraceState
from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.training.feed import ProcedureSettings
from rastrainer_simulator.training.procedure_phases import ProcedurePhases
from rastrainer_simulator.training.rules import TrainingSettings
from rastrainer_simulator.training.true_error import PlacedHead

if TYPE_CHECKING:
    from rastrainer.scenario.scenario import Scenario
    from rastrainer.scenario.tasks import Task


def trial_seed(seed: int, number: int) -> int:
    """Return the seed of a session's `number`-th trial, 0 … 2^53 − 1 (exact in any JSON reader)."""
    return int.from_bytes(_digest("seed", seed, number)[:8], "big") >> 11


def trial_id(seed: int, number: int) -> str:
    """Return the ID of a session's `number`-th trial, shaped like a random UUID (version 4)."""
    return str(uuid.UUID(bytes=_digest("id", seed, number)[:16], version=4))


def _digest(what: str, seed: int, number: int) -> bytes:
    return hashlib.sha256(f"{what}:{seed}:{number}".encode()).digest()


@dataclass(frozen=True)
class StartedTrial:
    """A trial as StartTask makes it.

    Attributes:
        seed: of the head's pose: as secret as the pose.
        task: the points to touch.
        head: as the tip meets it.
        phases: of the procedure that follows the touches; None without one.
        state: before its first instruction.
    """

    seed: int
    task: Task
    head: PlacedHead
    phases: ProcedurePhases | None
    state: TrainingState


class TrialStarter:
    """Starts the trials of a session, each with an ID and a seed of its own."""

    def __init__(
        self,
        scenario: Scenario,
        seed: int,
        settings: TrainingSettings,
        procedure: ProcedureSettings,
        texts: Texts,
    ) -> None:
        self._scenario = scenario
        self._seed = seed
        self._settings = settings
        self._procedure_settings = procedure
        self._texts = texts
        self._number = 0

    def start(self, arguments: Mapping[str, Any], revision: int) -> StartedTrial:
        """Return a trial by the arguments of StartTask; `revision` is the last one before it.

        Raises:
            InputError: the scenario has no such task or procedure, or its head cannot be read.
        """
        number, procedure = self._number, arguments.get("procedure") or ""
        skin = SkinShift.from_json(arguments.get("skin") or self._scenario.skin.amounts)
        method = method_of(arguments.get("method"))
        task = task_by_method(self._scenario, arguments["task"], method)
        phases = self._phases(procedure, task) if procedure else None
        chosen = arguments.get("seed")
        seed = trial_seed(self._seed, number) if chosen is None else chosen
        head = PlacedHead.of_trial(self._scenario, task, seed, skin)
        self._number += 1
        state = TrainingState(
            phase=Phase.RUNNING,
            trainee=arguments["trainee"],
            task=task.name,
            mode=arguments["mode"],
            trial_id=arguments.get("trialId") or trial_id(self._seed, number),
            next_point=task.labels[0],
            revision=revision,
            procedure=ProcedureState(procedure) if procedure else None,
            method=method,
            trace=TraceState() if method in TRACED_METHODS else None,
        )
        return StartedTrial(seed, task, head, phases, state)

    def _phases(self, procedure: str, task: Task) -> ProcedurePhases:
        plan = self._scenario.procedure(procedure)
        settings = self._procedure_settings
        return ProcedurePhases(plan, task.labels, self._settings, settings, self._texts)
