import pytest

from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.model import load_robot


@pytest.fixture(scope="module")
def robot():
    return load_robot()


@pytest.fixture(scope="module")
def fabrik(robot):
    return Fabrik(robot)
