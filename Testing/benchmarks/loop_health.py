"""How punctual the control loop of a running simulator is, as its heartbeat tells."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rastrainer.igtl.client import Client
from rastrainer.protocol import Device


class Health(NamedTuple):
    """Ticks that were due so far, and how many of them were late by more than 1 ms or skipped."""

    due: int
    missed: int


@dataclass(frozen=True)
class Punctuality:
    """Of a stretch of time.

    Attributes:
        shares: of ticks that were on time in each second, percent.
        on_time: of all ticks, 0…1.
        ticks: that were due.
    """

    shares: np.ndarray
    on_time: float
    ticks: int


def read_health(client: Client) -> Health:
    """Wait for the next heartbeat, which comes once a second."""
    beat = json.loads(client.wait_for(Device.SIM_SERVER).content.message)
    skipped = beat["skippedTicks"]
    return Health(beat["ticks"] + skipped, beat["lateTicks"] + skipped)


def punctuality(healths: list[Health]) -> Punctuality:
    """Return what several heartbeats in a row tell."""
    due, missed = np.diff(np.unique(np.array(healths), axis=0), axis=0).T
    shares = 100.0 * (1.0 - missed / due)
    return Punctuality(shares, float(1.0 - missed.sum() / due.sum()), int(due.sum()))
