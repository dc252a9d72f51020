"""Build the parts that every simulator builds first, so that forked processes have them already."""

from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.core.simulation import Simulation

Simulation(load_setup(), 0)
