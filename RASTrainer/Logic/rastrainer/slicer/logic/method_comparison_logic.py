"""Every method of registration on one head, side by side: simulated by the simulator's program."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer.progress import Progress, no_progress
from rastrainer.scenario.scenario import Scenario
from rastrainer.slicer.logic.simulator_logic import SimulatorLogic
from rastrainer.slicer.translation import _

LIMIT_BYTES = 1 << 20


@dataclass(frozen=True)
class ComparedMethod:
    """How a method has registered the trials; lengths in mm, root mean squares over trials.

    Attributes:
        name: a `RegistrationMethod`.
        residual: of the points that count; it does not show the error.
        expected: target error.
        interval: medians of the ends of its 95 % interval.
        true: target error.
        held: share of the intervals that hold the true error.
    """

    name: str
    residual: float
    expected: float
    interval: tuple[float, float]
    true: float
    held: float

    @classmethod
    def of(cls, name: str, value: Mapping[str, Any]) -> ComparedMethod:
        """Return what the program has written of a method.

        Raises:
            KeyError, TypeError, ValueError: it has not written that.
        """
        low, high = map(float, value["interval_mm"])
        return cls(
            name,
            float(value["residual_mm"]),
            float(value["expected_tre_mm"]),
            (low, high),
            float(value["true_tre_mm"]),
            float(value["interval_holds_share"]),
        )


class MethodComparisonLogic:
    """What the group Methods of registration does."""

    def __init__(self, simulator: SimulatorLogic) -> None:
        self._simulator = simulator

    def compare(
        self, scenario: Scenario, trials: int, skinShiftMm: float, progress: Progress = no_progress
    ) -> tuple[ComparedMethod, ...]:
        """Return how each method for which a head has the points registers simulated trials.

        Args:
            scenario: whose head it is.
            trials: how many.
            skinShiftMm: between imaging and operation, RMS.
            progress: see `ScenarioFiles`.

        Raises:
            InputError: the head cannot be used.
        """
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary) / "methods"
            words = ["compare-methods", "--scenario", str(scenario.folder), "-o", str(folder)]
            words += ["--trials", str(trials), "--skin-shift", str(skinShiftMm)]
            self._simulator.run(words, progress)
            compared = read_json(folder / "methods.json", LIMIT_BYTES)
        try:
            return tuple(ComparedMethod.of(*each) for each in compared["methods"].items())
        except (KeyError, TypeError, ValueError, AttributeError):
            raise InputError(_("The simulator's program is of another version.")) from None
