import numpy as np
import pytest
import trimesh
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

from rastrainer.errors import InputError
from rastrainer.head_mesh import HeadMesh
from rastrainer.protocol import Proximity
from rastrainer.scenario import Camera, Furniture
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import load_robot
from rastrainer_simulator.views.head_actors import ShownHead
from rastrainer_simulator.views.offscreen import write_png
from rastrainer_simulator.views.picture import render_robot_picture
from rastrainer_simulator.views.skin_marks import (
    DOT_LIFT,
    NUMBER_HEIGHT,
    NUMBER_LIFT,
    RIM_LIFT,
    skin_marks,
)

RADIUS = 80.0
SIZE = (480, 270)
UP = np.array([0.0, 0.0, 1.0])
FAR = Camera(np.array([660.0, -2350.0, 950.0]), np.array([420.0, 0.0, 330.0]), UP, 24.0)
FURNITURE = Furniture(np.array([300.0, 0.0]), np.array([1300.0, 1000.0, 40.0]), 80.0)
FRONT = RADIUS * np.array([[0.0, 1.0, 0.0], [0.5, 0.75**0.5, 0.0], [-0.5, 0.75**0.5, 0.0]])


def close_up(target_mm: np.ndarray) -> Camera:
    return Camera(target_mm + np.array([250.0, -750.0, 280.0]), target_mm, UP, 20.0)


@pytest.fixture(scope="module")
def ball() -> HeadMesh:
    sphere = trimesh.creation.icosphere(subdivisions=5, radius=RADIUS)
    return HeadMesh(np.array(sphere.vertices), np.array(sphere.faces))


@pytest.fixture(scope="module")
def head(ball) -> ShownHead:
    """A ball beside the tool, its face to the camera: one point done, one next, one waiting."""
    pose = np.diag([-1.0, -1.0, 1.0, 1.0])
    pose[:3, 3] = 760.0, 0.0, 300.0
    return ShownHead(ball, pose, FRONT, ("1", "2", "3"), frozenset({"1"}), "2")


@pytest.fixture(scope="module")
def picture(tmp_path_factory, head):
    """Render the robot at home and return the pixels, (height, width, 3) int."""
    robot = load_robot()
    links = make_kinematics(robot).links(np.array(robot.home))

    def render(**arguments) -> np.ndarray:
        path = tmp_path_factory.mktemp("pictures") / "robot.png"
        render_robot_picture(path, robot, links, head, FURNITURE, size=SIZE, **arguments)
        return _pixels(path)

    return render


def _pixels(path) -> np.ndarray:
    reader = vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, 3)
    return pixels[::-1].astype(int)


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


def test_the_far_picture_shows_an_orange_and_grey_robot_beside_a_head(far):
    assert far.shape == (SIZE[1], SIZE[0], 3)
    assert 0.005 < _orange(far) < 0.1
    assert 0.005 < _skin(far) < 0.1
    left = far[:, : SIZE[0] // 2]
    assert _orange(left) > 0.005, "the robot stands to the left of the head"


def test_the_picture_is_neither_empty_nor_overexposed(far):
    assert far.std() > 20
    assert _share(far, 254, 255) < 0.02
    assert _share(far, 0, 2) < 0.02


@pytest.fixture(scope="module")
def tip(picture):
    """Return a close picture of the tool's tip for a proximity."""
    robot = load_robot()
    target = make_kinematics(robot).tip(np.array(robot.home))[:3, 3] * 1000
    return lambda proximity: picture(camera=close_up(target), proximity=proximity)


def test_the_tool_tip_is_blue_when_free_and_red_when_near_or_touching(tip):
    blue, red = ((0, 40, 200), (60, 110, 255)), ((200, 0, 0), (255, 60, 60))
    free = tip(Proximity.FREE)
    assert _share(free, *blue) > 1e-4
    assert _share(free, *red) == 0
    for proximity in (Proximity.PROXIMITY, Proximity.CONTACT):
        near = tip(proximity)
        assert _share(near, *red) > 1e-4
        assert _share(near, *blue) == 0


def test_fiducials_are_colored_by_their_state_and_numbered(picture, head):
    pixels = picture(camera=close_up(head.head_to_world[:3, 3]))
    assert _share(pixels, (10, 130, 40), (60, 190, 90)) > 1e-4, "touched: green"
    assert _share(pixels, (220, 180, 0), (255, 225, 60)) > 1e-4, "next: yellow"
    assert _share(pixels, (10, 40, 130), (60, 90, 190)) > 1e-4, "waiting: blue"
    assert _share(pixels, (0, 0, 20), (60, 60, 80)) > 1e-4, "numbers: nearly black"


def test_an_inset_shows_a_second_view_in_a_white_frame(picture, far, head):
    both = picture(camera=FAR, inset=close_up(head.head_to_world[:3, 3]))
    changed = np.argwhere(np.any(np.abs(both - far) > 60, axis=2))
    (top, left), (bottom, right) = changed.min(axis=0), changed.max(axis=0)
    assert left > SIZE[0] / 2
    assert bottom < SIZE[1] / 2
    assert np.all(both[top, left : right + 1] == 255)
    assert _skin(both[top:bottom, left:right]) > 0.05


def test_an_unwritable_picture_is_refused_in_one_sentence(tmp_path):
    with pytest.raises(InputError, match=r"robot\.png cannot be written: No such file"):
        write_png(np.zeros((2, 2, 3), np.uint8), tmp_path / "nowhere" / "robot.png")


def _points(shape) -> np.ndarray:
    return vtk_to_numpy(shape.GetPoints().GetData()).astype(float)


def test_marks_lie_on_the_skin_and_follow_its_curve(ball):
    for mark in skin_marks(ball, FRONT, ("7", "12", "15")):
        for shape, lift in (
            (mark.dot, DOT_LIFT),
            (mark.rim, RIM_LIFT),
            (mark.number, NUMBER_LIFT),
        ):
            heights = np.linalg.norm(_points(shape), axis=1) - RADIUS
            assert np.all(np.abs(heights - lift) < 0.3)


def test_a_number_reads_from_outside_with_the_patients_superior_up(ball):
    mark = skin_marks(ball, FRONT[:1], ("1L",))[0]
    points = _points(mark.number)
    assert np.ptp(points[:, 2]) == pytest.approx(NUMBER_HEIGHT, rel=0.05)
    # Seen from in front of the face, the patient's right (+x) is on the left.
    foot = points[points[:, 2] < points[:, 2].min() + 0.15 * NUMBER_HEIGHT]
    assert foot[:, 0].min() < points[:, 0].mean(), "the foot of the L reaches to the viewer's right"
    assert np.median(foot[:, 0]) < np.median(points[:, 0])


def test_numbers_keep_away_from_other_fiducials():
    sphere = trimesh.creation.icosphere(subdivisions=4, radius=RADIUS)
    dense = HeadMesh(np.array(sphere.vertices), np.array(sphere.faces))
    angles = np.radians([-12, 0, 12])
    row = RADIUS * np.column_stack([np.sin(angles), np.cos(angles), np.zeros(3)])
    for index, mark in enumerate(skin_marks(dense, row, ("1", "2", "3"))):
        distances = np.linalg.norm(_points(mark.number)[:, None] - row, axis=2)
        assert distances.min() > 5.2, "clear of every dot's rim"
        assert np.argmin(distances.mean(axis=0)) == index
