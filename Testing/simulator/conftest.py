"""Fixtures of simulator tests."""

from dataclasses import replace

import pytest

from rastrainer.protocol import TouchRule
from rastrainer_simulator.core.setup import SimulationSetup, load_setup
from rastrainer_simulator.core.simulation import Simulation
from Testing.simulator.planned_procedures import procedure_setup


@pytest.fixture(scope="session")
def setup() -> SimulationSetup:
    """Return the scenario, robot and settings that come with RASTrainer."""
    return load_setup()


@pytest.fixture(scope="session")
def scenario(setup):
    """Return the scenario that comes with RASTrainer."""
    return setup.scenario


@pytest.fixture(scope="session")
def anywhere(setup):
    """Return a setup in which every touch counts, wherever the tip is."""
    training = replace(
        setup.settings.training, acceptance_radius=10.0, touch_rule=TouchRule.WITHIN_RADIUS
    )
    return replace(setup, settings=replace(setup.settings, training=training))


@pytest.fixture(scope="module")
def simulation(anywhere):
    """Return a simulation in which every touch counts."""
    return Simulation(anywhere, 3)


@pytest.fixture(scope="session")
def planned(tmp_path_factory):
    """Return a setup with procedures, in which every touch counts, wherever the tip is."""
    return procedure_setup(tmp_path_factory.mktemp("planned") / "scenario")
