"""What a finished tutorial tells of a trainee: for its file, and for the journal of a trial run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from rastrainer.errors import InputError
from rastrainer.files.json_fields import Fields
from rastrainer.protocol import Mode
from rastrainer_simulator.input.inputs import SourceKind

GUIDED_TOUCHES = 3
FORMAT_VERSION = 1
DECIMALS = 3
LONGEST_S, MAX_MM = 1e6, 1e4


@dataclass(frozen=True)
class TutorialOutcome:
    """A finished tutorial.

    Attributes:
        trainee: pseudonym.
        device: value of the `SourceKind` that the arm was driven with.
        mode: "desktop" or "hmd".
        seconds: how long it took, menus excluded.
        first_error_mm: of the first touch.
        errors_mm: of the guided touches at the end.
        step_seconds: the same as `seconds` for each step, by name.
    """

    trainee: str
    device: str
    mode: str
    seconds: float
    first_error_mm: float
    errors_mm: tuple[float, ...]
    step_seconds: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, fields: Fields) -> TutorialOutcome:
        """Return the tutorial that a file holds.

        Raises:
            InputError: a field is wrong.
        """
        if fields.number("formatVersion", 0, 1e9) != FORMAT_VERSION:
            raise InputError(f"The tutorial's formatVersion must be {FORMAT_VERSION}.")
        steps = fields.fields("stepSeconds")
        return cls(
            trainee=fields.text("trainee", 64),
            device=fields.one_of("device", tuple(kind.value for kind in SourceKind)),
            mode=fields.one_of("mode", tuple(mode.value for mode in Mode)),
            seconds=fields.number("seconds", 0, LONGEST_S),
            first_error_mm=fields.number("firstErrorMm", 0, MAX_MM),
            errors_mm=tuple(fields.numbers("errorsMm", GUIDED_TOUCHES, MAX_MM)),
            step_seconds={step: steps.number(step, 0, LONGEST_S) for step in steps.names()},
        )

    def to_json(self) -> dict[str, Any]:
        """Return the JSON object that `of` reads."""
        steps = {step: round(seconds, DECIMALS) for step, seconds in self.step_seconds.items()}
        return {
            "formatVersion": FORMAT_VERSION,
            "trainee": self.trainee,
            "device": self.device,
            "mode": self.mode,
            "seconds": round(self.seconds, DECIMALS),
            "firstErrorMm": round(self.first_error_mm, DECIMALS),
            "errorsMm": [round(error, DECIMALS) for error in self.errors_mm],
            "stepSeconds": steps,
        }

    def entry(self) -> dict[str, Any]:
        """Return what goes into the journal of a trial run, without its times."""
        kept = ("device", "mode", "seconds", "firstErrorMm", "errorsMm")
        values = self.to_json()
        return {"kind": "tutorial", **{name: values[name] for name in kept}}
