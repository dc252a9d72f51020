import numpy as np
import pytest
from scipy.spatial import cKDTree

from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer_simulator.authoring.task_proposal import smooth_places
from rastrainer_simulator.scene.skin_marks import NUMBER_HEIGHT, RIM_RADIUS, skin_marks
from Testing.domain.head.spheres import RADIUS_MM, sphere_mesh

FRONT = RADIUS_MM * np.array([[0.0, 1.0, 0.0], [0.5, 0.75**0.5, 0.0], [-0.5, 0.75**0.5, 0.0]])
LABELS = [str(number) for number in range(1, 16)]
TASK, CROWDED = "task-5", "crowded"
OTHER_TASKS = ("trial-run", "task-1", "task-2", "task-3", "task-4")


@pytest.fixture(scope="module")
def ball() -> HeadMesh:
    return sphere_mesh(5)


def test_a_number_is_readable_from_outside_with_the_patients_superior_up(ball):
    points = 1000.0 * skin_marks(ball, FRONT[:1], ("1L",))[0]["number"].vertices
    assert np.ptp(points[:, 2]) == pytest.approx(NUMBER_HEIGHT, rel=0.05)
    # Seen from in front of the face, the patient's right (+x) is on the left.
    foot = points[points[:, 2] < points[:, 2].min() + 0.15 * NUMBER_HEIGHT]
    assert foot[:, 0].min() < points[:, 0].mean(), "the foot of the L reaches to the viewer's right"
    assert np.median(foot[:, 0]) < np.median(points[:, 0])


@pytest.fixture(scope="module")
def head(scenario) -> HeadMesh:
    return read_head_mesh(scenario.head)


@pytest.fixture(
    scope="module",
    params=[
        TASK,
        *(pytest.param(task, marks=pytest.mark.soak) for task in (CROWDED, *OTHER_TASKS)),
    ],
)
def points(request, scenario, head) -> np.ndarray:
    """The fiducials of a task that comes with RASTrainer, or drawn at random."""
    if request.param != CROWDED:
        return scenario.task(request.param).fiducials
    places = head.vertices[smooth_places(head, 10.0)]
    places = places[places[:, 1] > 20.0]
    chosen = np.empty((0, 3))
    for index in np.random.default_rng(3).permutation(len(places)):
        place = places[index]
        if len(chosen) < 15 and np.all(np.linalg.norm(chosen - place, axis=1) >= 20.0):
            chosen = np.vstack([chosen, place])
    assert len(chosen) == 15
    return chosen


@pytest.fixture(scope="module")
def marks(head, points):
    return skin_marks(head, points, LABELS)


def apart(first: np.ndarray, second: np.ndarray) -> float:
    return float(cKDTree(second).query(first)[0].min())


def places_on(shape) -> np.ndarray:
    """Return the vertices and the middles of the triangles, mm: less than 1.5 between them."""
    points = 1000.0 * shape.vertices
    return np.concatenate([points, points[shape.triangles].mean(axis=1)])


def test_no_number_touches_an_arrow_a_fiducial_or_another_number(marks):
    arrows = np.concatenate([places_on(mark["arrow"]) for mark in marks if "arrow" in mark])
    rims = np.concatenate([places_on(mark["rim"]) for mark in marks])
    for number, mark in enumerate(marks):
        own = places_on(mark["number"])
        assert apart(own, arrows) > 1.0
        assert apart(own, rims) > 1.0
        for other in marks[:number]:
            assert apart(own, places_on(other["number"])) > 4.0


def test_arrows_touch_no_fiducials_and_are_clear_of_each_other(marks):
    arrows = [mark["arrow"] for mark in marks if "arrow" in mark]
    for index, arrow in enumerate(arrows):
        for mark in marks:
            assert apart(places_on(arrow), places_on(mark["rim"])) > 0.7
        for other in arrows[:index]:
            assert apart(places_on(arrow), places_on(other)) > 3.0


def test_every_arrow_starts_at_its_fiducial_and_points_to_the_next(marks, points):
    assert "arrow" not in marks[-1]
    for start, goal, mark in zip(points, points[1:], marks, strict=False):
        places = 1000.0 * mark["arrow"].vertices
        ribbon = places.reshape(-1, 5, 3).mean(axis=1)
        assert np.linalg.norm(ribbon[0] - start) < RIM_RADIUS + 2.0
        assert np.linalg.norm(ribbon[-1] - ribbon[0]) >= 5.0
        assert np.linalg.norm(goal - ribbon[-1]) < np.linalg.norm(goal - ribbon[0])
        tip_width = np.linalg.norm(places[-1] - places[-5])
        assert tip_width < 0.1, "it comes to a point"
