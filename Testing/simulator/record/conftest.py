"""What the tests of records share."""

from __future__ import annotations

import pytest

from rastrainer_simulator.core.simulation import Simulation


@pytest.fixture(scope="module")
def simulation(anywhere):
    return Simulation(anywhere, 3)
