"""What the simulator's tests share."""

from __future__ import annotations

import pytest

from rastrainer_simulator.setup import SimulationSetup, load_setup


@pytest.fixture(scope="session")
def setup() -> SimulationSetup:
    """Return the scenario, robot and settings that come with RASTrainer."""
    return load_setup()


@pytest.fixture(scope="session")
def scenario(setup):
    """Return the scenario that comes with RASTrainer."""
    return setup.scenario
