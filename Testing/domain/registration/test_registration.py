"""Registrations and their residuals, and points that are refused or named by a warning."""

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
def test_leaving_points_out_registers_the_others(kind, touched_head):
    moving, fixed, _ = touched_head(4)
    labels = [f"F-{i}" for i in range(15)]
    fewer = register(moving, fixed, kind, labels).without("F-3", "F-7")
    kept = [i for i in range(15) if i not in (3, 7)]
    again = register(moving[kept], fixed[kept], kind)
    np.testing.assert_array_equal(fewer.matrix, again.matrix)
    assert fewer.labels == tuple(labels[i] for i in kept)
    assert fewer.fre_mm == again.fre_mm


@pytest.mark.parametrize("kind", KINDS)
def test_leave_one_out_returns_the_distance_predicted_by_the_other_points(kind, touched_head):
    moving, fixed, _ = touched_head(8)
    distances = register(moving, fixed, kind).leave_one_out_mm()
    for i in range(15):
        others = vtk_matrix(np.delete(moving, i, 0), np.delete(fixed, i, 0), kind)
        expected = np.linalg.norm(transforms.apply(others, moving[i]) - fixed[i])
        assert distances[i] == pytest.approx(expected, abs=1e-6)


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
        (GOOD, [["a", "b", "c"]], "rigid", "fixed points .* must be numbers"),
        (GOOD, spoiled(0, 1e300), "rigid", r"fixed points .* Point 1 has .* within ±1000000 mm"),
        (line(), line(), "rigid", r"moving points \(1, 2, 3, 4, 5\) lie on one line"),
        (plane(), plane(), "affine", r"moving points \(1, .*\) lie in one plane.*choose rigid"),
        (GOOD, GOOD, "elastic", '"elastic" is unknown; it must be one of rigid, similarity'),
    ],
)
def test_unusable_points_are_refused_with_a_message(moving, fixed, kind, words):
    with pytest.raises(InputError, match=words) as caught:
        register(moving, fixed, kind)
    assert "\n" not in str(caught.value)


def test_coplanar_points_have_a_rigid_and_a_similarity_fit():
    assert list(register_all_kinds(plane(), plane())) == ["rigid", "similarity"]
    assert list(register_all_kinds(GOOD, GOOD)) == ["rigid", "similarity", "affine"]
    with pytest.raises(InputError, match="lie on one line"):
        register_all_kinds(line(), line())


def test_weights_apply_only_to_the_rigid_fit():
    weights = np.arange(1.0, 6.0)
    fits = register_all_kinds(GOOD, GOOD + spoiled(1, 0.5), weights=weights)
    assert [fit.weights is None for fit in fits.values()] == [False, True, True]


@pytest.fixture(params=[6, pytest.param(60, marks=pytest.mark.soak)], ids="{} heads".format)
def seeds(request):
    return range(request.param)


def faults(moving, fixed, kind="rigid"):
    return [(w.code, w.points) for w in register(moving, fixed, kind).warnings]


def labels(*rows):
    return tuple(str(row + 1) for row in sorted(rows))


ALL = labels(*range(15))


def direction(rng):
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector)


@pytest.mark.parametrize("heads", [30, pytest.param(500, marks=pytest.mark.soak)])
def test_clean_heads_raise_no_alarm(touched_head, heads):
    for seed in range(heads):
        moving, fixed, _ = touched_head(seed)
        assert faults(moving, fixed, KINDS[seed % 3]) == []


@pytest.mark.parametrize("kind", KINDS)
def test_a_mirrored_set_is_reported_even_if_the_fit_hides_it(kind, touched_head, seeds):
    for seed in seeds:
        moving, fixed, rng = touched_head(seed)
        moving[:, rng.integers(3)] *= -1
        assert faults(moving, fixed, kind) == [("mirrored", ALL)]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scale", [1 / 25.4, 0.9, 1.05, 1000])
def test_a_wrong_scale_is_reported_even_if_the_fit_hides_it(kind, scale, touched_head):
    for seed in range(3):
        moving, fixed, _ = touched_head(seed)
        assert faults(moving * scale, fixed, kind) == [("scale", ALL)]


def test_two_swapped_labels_are_reported(touched_head, seeds):
    for seed in seeds:
        moving, fixed, rng = touched_head(seed)
        a, b = rng.choice(15, 2, replace=False)
        if np.linalg.norm(fixed[a] - fixed[b]) < 12:
            continue
        moving[[a, b]] = moving[[b, a]]
        assert faults(moving, fixed) == [("order", labels(a, b))]


def test_a_reversed_or_shifted_list_is_reported(touched_head):
    moving, fixed, _ = touched_head(1)
    backward = register(moving[::-1], fixed).warnings
    assert [w.code for w in backward] == ["order"]
    assert "reverse order" in backward[0].message
    shifted = register(np.roll(moving, 2, axis=0), fixed).warnings
    assert [w.code for w in shifted] == ["order"]
    assert "the one at 3 belongs to the fixed point 1" in shifted[0].message


@pytest.mark.parametrize("size_mm", [12, 30, 1000])
def test_one_bad_touch_is_reported(size_mm, touched_head, seeds):
    for seed in seeds:
        moving, fixed, rng = touched_head(seed)
        row = rng.integers(15)
        moving[row] += size_mm * direction(rng)
        assert faults(moving, fixed) == [("outlier", labels(row))]


def test_two_bad_touches_do_not_hide_each_other(touched_head, seeds):
    for seed in seeds:
        moving, fixed, rng = touched_head(seed)
        a, b = sorted(rng.choice(15, 2, replace=False))
        moving[a] += 25 * direction(rng)
        moving[b] += 25 * direction(rng)
        assert faults(moving, fixed) == [("outlier", labels(a)), ("outlier", labels(b))]


def test_unrelated_lists_are_reported(touched_head, seeds):
    for seed in seeds:
        moving, fixed, rng = touched_head(seed)
        assert ("poor-fit", ALL) in faults(moving[rng.permutation(15)], fixed)


def test_flat_sets_are_reported_if_they_make_the_fit_uncertain(touched_head):
    _, fixed, _ = touched_head(4)
    assert [code for code, _ in faults(fixed * [1, 1, 0.01], fixed * [1, 1, 0.01], "affine")] == [
        "nearly-coplanar"
    ] * 2
    assert faults(fixed * [1, 1, 0.01], fixed * [1, 1, 0.01], "rigid") == []
    thin = fixed * [1, 0.01, 0.01]
    assert [code for code, _ in faults(thin, thin)] == ["nearly-collinear"] * 2
