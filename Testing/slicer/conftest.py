import pytest

from rastrainer.slicer.headless_scene import HeadlessScene
from Testing.slicer.simulator_double import SimulatorDouble


@pytest.fixture
def headless_scene():
    return HeadlessScene()


@pytest.fixture
def scene(headless_scene):
    return headless_scene.scene


@pytest.fixture
def simulator():
    with SimulatorDouble() as double:
        yield double
