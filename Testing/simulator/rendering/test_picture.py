"""Pictures of the scene, and their legend and scale."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from rastrainer.head.mesh import HeadMesh
from rastrainer.protocol import Proximity
from rastrainer.scenario.points import Task
from rastrainer.scenario.scenario import Camera, OperatingTable, Stand
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.rendering.lighting import Shadows
from rastrainer_simulator.rendering.picture import looks_of, posed, render_picture
from rastrainer_simulator.rendering.procedure_picture import INK, bar_mm, paint_scale
from rastrainer_simulator.robot.model import load_robot
from rastrainer_simulator.scene.room_nodes import room_nodes, stand_node, table_node
from rastrainer_simulator.scene.scene_glb import head_node, robot_nodes
from Testing.domain.head.spheres import RADIUS_MM, sphere_mesh

SIZE = (480, 270)
UP = np.array([0.0, 0.0, 1.0])
FAR = Camera(np.array([660.0, -2350.0, 950.0]), np.array([420.0, 0.0, 330.0]), UP, 24.0)
TABLE = OperatingTable(np.array([300.0, 0.0]), np.array([1300.0, 1000.0, 40.0]))
STAND = Stand(80.0)
FRONT = RADIUS_MM * np.array([[0.0, 1.0, 0.0], [0.5, 0.75**0.5, 0.0], [-0.5, 0.75**0.5, 0.0]])


def close_up(target_mm: np.ndarray) -> Camera:
    return Camera(target_mm + np.array([250.0, -750.0, 280.0]), target_mm, UP, 20.0)


@pytest.fixture(scope="module")
def ball() -> HeadMesh:
    return sphere_mesh(5)


@pytest.fixture(scope="module")
def head_to_world() -> np.ndarray:
    """A ball next to the tool, its face to the camera."""
    pose = np.diag([-1.0, -1.0, 1.0, 1.0])
    pose[:3, 3] = 760.0, 0.0, 300.0
    return pose


@pytest.fixture(scope="module")
def picture(tmp_path_factory, ball, head_to_world):
    """Render the robot at home and return the pixels, (height, width, 3) int.

    One point is done, one is next, one waits.
    """
    robot = load_robot()
    poses = posed(robot, robot.home, head_to_world, ball)
    base = (head_to_world @ np.append(ball.base, 1.0))[:3] / MM_PER_M
    nodes = [
        *robot_nodes(robot),
        head_node(ball, Task("ball", "Ball", Path(), 1.0, labels=("1", "2", "3"), fiducials=FRONT)),
        stand_node(STAND, base),
        table_node(TABLE, STAND, base),
        *room_nodes(),
    ]

    def render(proximity=Proximity.FREE, **arguments) -> np.ndarray:
        path = tmp_path_factory.mktemp("pictures") / "robot.png"
        looks = looks_of(["1"], "2", proximity)
        arguments.setdefault("shadows", Shadows.SMALL)
        render_picture(path, nodes, poses, looks, size=SIZE, **arguments)
        return np.asarray(Image.open(path).convert("RGB")).astype(int)

    return render


def _share(pixels: np.ndarray, low, high) -> float:
    return float(np.all((pixels >= low) & (pixels <= high), axis=2).mean())


def _orange(pixels: np.ndarray) -> float:
    red, _, blue = np.moveaxis(pixels, 2, 0)
    return float(((red > 140) & (red - blue > 120)).mean())


def _skin(pixels: np.ndarray) -> float:
    red, green, blue = np.moveaxis(pixels, 2, 0)
    return float(((red > 130) & (red - blue > 40) & (red - blue < 110) & (green > blue)).mean())


@pytest.fixture(scope="module")
def far(picture) -> np.ndarray:
    return picture(camera=FAR)


def test_the_far_picture_shows_an_orange_and_gray_robot_beside_a_head(far):
    assert far.shape == (SIZE[1], SIZE[0], 3)
    assert 0.005 < _orange(far) < 0.1
    assert 0.005 < _skin(far) < 0.1
    left = far[:, : SIZE[0] // 2]
    assert _orange(left) > 0.005, "the robot stands to the left of the head"


def test_fiducials_are_colored_by_their_state_and_numbered(picture, head_to_world):
    pixels = picture(camera=close_up(head_to_world[:3, 3]))
    assert _share(pixels, (20, 120, 45), (90, 190, 110)) > 1e-4, "touched: green"
    assert _share(pixels, (220, 190, 40), (255, 240, 100)) > 1e-4, "next: yellow"
    assert _share(pixels, (0, 30, 125), (60, 90, 190)) > 1e-4, "waiting: blue"
    assert _share(pixels, (0, 0, 20), (60, 60, 80)) > 1e-4, "numbers: nearly black"


def test_the_scale_bar_is_a_round_number_and_as_long_as_its_label_says():
    assert [bar_mm(height) for height in (194.0, 4.1, 0.9)] == pytest.approx([20.0, 1.0, 0.2])
    pixels = np.full((400, 640, 3), 255, dtype=np.uint8)
    paint_scale(pixels, 80.0)
    is_ink = (pixels == INK).all(axis=2)
    assert is_ink.any(axis=0).sum() == 20.0 / 80.0 * 400
