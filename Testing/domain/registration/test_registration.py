"""Registrations and their residuals, and the points that cannot be registered."""

import numpy as np
import pytest
import vtk

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.registration.fits import KINDS, fit
from rastrainer.registration.registration import register, register_all_kinds

VTK_MODES = {"rigid": "RigidBody", "similarity": "Similarity", "affine": "Affine"}


def vtk_matrix(moving, fixed, kind):
    landmark_transform = vtk.vtkLandmarkTransform()
    for points, take in (
        (moving, landmark_transform.SetSourceLandmarks),
        (fixed, landmark_transform.SetTargetLandmarks),
    ):
        landmarks = vtk.vtkPoints()
        landmarks.SetDataTypeToDouble()
        for point in points:
            landmarks.InsertNextPoint(point)
        take(landmarks)
    getattr(landmark_transform, f"SetModeTo{VTK_MODES[kind]}")()
    landmark_transform.Update()
    matrix = landmark_transform.GetMatrix()
    return np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])


@pytest.mark.parametrize("kind", KINDS)
def test_random_sets_map_as_vtk_landmark_transform_maps_them(kind, touched_head):
    worst_mm = 0.0
    for seed in range(60):
        moving, fixed, rng = touched_head(seed, count=4 + seed % 27)
        if seed % 3 == 0:
            moving = moving * rng.uniform(0.5, 2.0, 3)
        if seed % 10 == 0:
            moving = moving * [1, 1, -1]
        ours = fit(moving, fixed, kind)
        theirs = vtk_matrix(moving, fixed, kind)
        around = np.vstack([moving, moving.mean(axis=0) + rng.normal(size=(5, 3)) * 100])
        difference = transforms.apply(ours, around) - transforms.apply(theirs, around)
        worst_mm = max(worst_mm, np.abs(difference).max())
    assert worst_mm < 1e-6


@pytest.mark.parametrize("kind", KINDS)
def test_exact_points_give_the_exact_transform_and_no_error(kind, touched_head):
    _, fixed, rng = touched_head(5)
    true = transforms.inverse(vtk_matrix(*touched_head(6)[:2], "rigid"))
    if kind != "rigid":
        true[:3, :3] *= 1.01
    if kind == "affine":
        true[:3, :3] @= np.eye(3) + rng.normal(size=(3, 3)) * 0.01
    moving = transforms.apply(true, fixed)
    registration = register(moving, fixed, kind)
    np.testing.assert_allclose(registration.matrix @ true, np.eye(4), atol=1e-9)
    assert registration.fre_mm < 1e-9


@pytest.mark.parametrize("kind", KINDS)
def test_leaving_points_out_registers_the_others(kind, touched_head):
    moving, fixed, _ = touched_head(4)
    labels = [f"F-{i}" for i in range(15)]
    fewer = register(moving, fixed, kind, labels).without("F-3", "F-7")
    kept = [i for i in range(15) if i not in (3, 7)]
    again = register(moving[kept], fixed[kept], kind)
    np.testing.assert_array_equal(fewer.matrix, again.matrix)
    assert fewer.labels == tuple(labels[i] for i in kept)
    assert fewer.fre_mm == again.fre_mm


def test_leaving_out_an_unknown_point_lists_the_labels(touched_head):
    moving, fixed, _ = touched_head(4, count=4)
    with pytest.raises(InputError, match='No point is labeled "x"; the labels are 1, 2, 3, 4'):
        register(moving, fixed).without("x")


@pytest.mark.parametrize("kind", KINDS)
def test_leave_one_out_returns_the_distance_predicted_by_the_other_points(kind, touched_head):
    moving, fixed, _ = touched_head(8)
    distances = register(moving, fixed, kind).leave_one_out_mm()
    for i in range(15):
        others = vtk_matrix(np.delete(moving, i, 0), np.delete(fixed, i, 0), kind)
        expected = np.linalg.norm(transforms.apply(others, moving[i]) - fixed[i])
        assert distances[i] == pytest.approx(expected, abs=1e-6)


def test_the_inputs_are_not_changed(touched_head):
    moving, fixed, _ = touched_head(9)
    registration = register(moving, fixed)
    moving[0] = 0.0
    assert not (registration.moving_mm[0] == 0.0).any()
    with pytest.raises(ValueError, match="read-only"):
        registration.matrix[0, 0] = 2.0


def line(count=5):
    return np.linspace(0, 100, count)[:, None] * [[1.0, 2.0, -1.0]] + [300.0, 20.0, 10.0]


def plane(count=8):
    rng = np.random.default_rng(0)
    return rng.normal(size=(count, 2)) * 50 @ [[1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]


GOOD = np.array([[0, 0, 0], [80, 0, 0], [0, 90, 0], [0, 0, 70], [50, 60, 70]], dtype=float)


def spoiled(row, value):
    points = GOOD.copy()
    points[row, 1] = value
    return points


@pytest.mark.parametrize(
    ("moving", "fixed", "kind", "words"),
    [
        (GOOD[:4], GOOD, "rigid", "4 moving points and 5 fixed points"),
        (GOOD[:2], GOOD[:2], "rigid", "Rigid registration needs at least 3 .* only 2"),
        (GOOD[:1], GOOD[:1], "similarity", "Similarity .* there is only 1"),
        (GOOD[:3], GOOD[:3], "affine", "Affine registration needs at least 4"),
        ([], [], "rigid", "moving points .* at least one point"),
        (GOOD, [], "rigid", "fixed points .* at least one point"),
        (GOOD[:, :2], GOOD, "rigid", "moving points .* three coordinates"),
        ([[1, 2], [3]], GOOD, "rigid", "moving points .* must be numbers"),
        (GOOD, [["a", "b", "c"]], "rigid", "fixed points .* must be numbers"),
        (spoiled(2, np.nan), GOOD, "rigid", "moving points .* Point 3 has .* not a number"),
        (GOOD, spoiled(4, np.inf), "rigid", "fixed points .* Point 5 has .* not a number"),
        (GOOD, spoiled(0, 1e300), "rigid", r"fixed points .* Point 1 has .* within ±1000000 mm"),
        (line(), line(), "rigid", r"moving points \(1, 2, 3, 4, 5\) lie on one line"),
        (GOOD, line(), "similarity", r"fixed points \(1, 2, 3, 4, 5\) lie on one line"),
        (np.ones((4, 3)), GOOD[:4], "rigid", "All moving points .* the same place"),
        (plane(), plane(), "affine", r"moving points \(1, .*\) lie in one plane.*choose rigid"),
        (GOOD, GOOD, "elastic", '"elastic" is unknown; it must be one of rigid, similarity'),
        (np.zeros((1001, 3)), np.zeros((1001, 3)), "rigid", "at most 1000"),
    ],
)
def test_unusable_points_are_refused_with_a_message(moving, fixed, kind, words):
    with pytest.raises(InputError, match=words) as caught:
        register(moving, fixed, kind)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("labels", "words"),
    [(["a", "b"], "2 labels for 5"), (["a", "b", "c", "a", "d"], '"a" is given to two points')],
)
def test_labels_must_be_unique(labels, words):
    with pytest.raises(InputError, match=words):
        register(GOOD, GOOD, labels=labels)


def test_coplanar_points_have_a_rigid_and_a_similarity_fit():
    assert list(register_all_kinds(plane(), plane())) == ["rigid", "similarity"]
    assert list(register_all_kinds(GOOD, GOOD)) == ["rigid", "similarity", "affine"]
    with pytest.raises(InputError, match="lie on one line"):
        register_all_kinds(line(), line())


def test_weights_apply_only_to_the_rigid_fit():
    weights = np.arange(1.0, 6.0)
    fits = register_all_kinds(GOOD, GOOD + spoiled(1, 0.5), weights=weights)
    assert [fit.weights is None for fit in fits.values()] == [False, True, True]
