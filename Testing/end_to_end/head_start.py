"""Builds what every simulator builds first, so that what is forked afterward has it already."""

from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.core.simulation import Simulation

Simulation(load_setup(), 0)
