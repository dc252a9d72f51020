"""A gamepad in hands that have learned how fast the tip follows the sticks."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from Testing.simulator.flow.trainee import Pad

DEAD_ZONE = 0.12
SPEED_M_S, FINE_SPEED_M_S = 0.15, 0.02
"""The speed grows with the square of the push beyond the dead zone, up to these."""
FASTEST_M_S = 0.1


class TrainedPad(Pad):
    """Moves the tip at a speed, and zooms out the view, too."""

    BUTTONS: ClassVar = {**Pad.BUTTONS, "view_farther": "leftstick"}

    def move(self, velocity: np.ndarray) -> None:
        """Push the sticks for a velocity of the tip, (3,) float, m/s: right, forward, up."""
        wanted = float(np.linalg.norm(velocity))
        speed = min(wanted, FASTEST_M_S)
        is_fine = speed < FINE_SPEED_M_S
        share = speed / (FINE_SPEED_M_S if is_fine else SPEED_M_S)
        push = DEAD_ZONE + (1.0 - DEAD_ZONE) * share**0.5
        self.push(*(velocity * push / max(wanted, 1e-9)).tolist(), is_fine)

    def stop(self) -> None:
        """Release the sticks."""
        self.push(0.0, 0.0, 0.0, False)
