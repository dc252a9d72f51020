"""The virtual hand next to measurements of people, as `rastrainer calibrate` prints it."""

from __future__ import annotations

from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.virtual.calibration import calibrated
from Testing.error_rates.measured import Measured

HEADER = ("quantity", "simulated", "chosen for it", "published in")
REPEATS = 5


def quantities(_sets: int = 0) -> list[Measured]:
    """Return each quantity with its published range as the requirement."""
    return [
        Measured(
            f"{one.name}, {one.unit}".removesuffix(", "),
            one.simulated,
            at_least=one.least,
            at_most=one.most,
            further=(f"`{one.fitted}`" if one.fitted else "held out", one.source),
            is_share=False,
            digits=3,
        )
        for one in calibrated(load_setup(None), REPEATS)
    ]
