"""Points that cannot be registered end with one sentence that names what is wrong."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.registration.registration import register, register_all_kinds


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
        ([], [], "rigid", "There are no moving points"),
        (GOOD, [], "rigid", "There are no fixed points"),
        (GOOD[:, :2], GOOD, "rigid", "moving points must have three coordinates"),
        ([[1, 2], [3]], GOOD, "rigid", "moving points must be numbers"),
        (GOOD, [["a", "b", "c"]], "rigid", "fixed points must be numbers"),
        (spoiled(2, np.nan), GOOD, "rigid", "Point 3 of the moving points .* not a finite"),
        (GOOD, spoiled(4, np.inf), "rigid", "Point 5 of the fixed points .* not a finite"),
        (GOOD, spoiled(0, 1e300), "rigid", r"Point 1 of the fixed points .* beyond ±1000000 mm"),
        (line(), line(), "rigid", r"moving points \(1, 2, 3, 4, 5\) lie on one line"),
        (GOOD, line(), "similarity", r"fixed points \(1, 2, 3, 4, 5\) lie on one line"),
        (np.ones((4, 3)), GOOD[:4], "rigid", "All moving points .* the same place"),
        (plane(), plane(), "affine", r"moving points \(1, .*\) lie in one plane.*choose rigid"),
        (GOOD, GOOD, "elastic", '"elastic" is unknown; it must be one of rigid, similarity'),
        (np.zeros((1001, 3)), np.zeros((1001, 3)), "rigid", "at most 1000"),
    ],
)
def test_unfit_points_are_refused_with_a_sentence(moving, fixed, kind, words):
    with pytest.raises(InputError, match=words) as caught:
        register(moving, fixed, kind)
    assert "\n" not in str(caught.value)


def test_a_line_on_the_mri_is_refused_although_the_touches_scatter_about_it():
    touches = line() + np.random.default_rng(0).normal(size=(5, 3))
    with pytest.raises(InputError, match=r"fixed points .* lie on one line"):
        register(touches, line())


@pytest.mark.parametrize(
    ("labels", "words"),
    [(["a", "b"], "2 labels for 5"), (["a", "b", "c", "a", "d"], '"a" is given to two points')],
)
def test_labels_must_name_each_point_once(labels, words):
    with pytest.raises(InputError, match=words):
        register(GOOD, GOOD, labels=labels)


def test_far_from_the_origin_and_small_sets_are_judged_by_their_own_extent():
    assert register(GOOD / 1000 + 1000, GOOD / 1000).fre_mm < 1e-9


def test_points_in_one_plane_have_the_rigid_and_the_similarity_fit():
    assert list(register_all_kinds(plane(), plane())) == ["rigid", "similarity"]
    assert list(register_all_kinds(GOOD, GOOD)) == ["rigid", "similarity", "affine"]
    with pytest.raises(InputError, match="lie on one line"):
        register_all_kinds(line(), line())


def test_weights_are_of_the_rigid_fit_alone():
    weights = np.arange(1.0, 6.0)
    fits = register_all_kinds(GOOD, GOOD + spoiled(1, 0.5), weights=weights)
    assert [fit.weights is None for fit in fits.values()] == [False, True, True]
