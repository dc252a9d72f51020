"""Suspicious points are registered with a warning that names them."""

import numpy as np
import pytest

from rastrainer.json_records import record_to_json
from rastrainer.registration.fits import KINDS
from rastrainer.registration.registration import register


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


@pytest.mark.parametrize("count", [3, 4, 5, 6, 30, 100])
def test_small_and_large_sets_raise_no_alarm(count, touched_head):
    for seed in range(5):
        moving, fixed, _ = touched_head(seed, count=count)
        found = {code for code, _ in faults(moving, fixed)}
        assert found <= {"nearly-collinear"}


@pytest.mark.parametrize("kind", KINDS)
def test_a_mirrored_set_is_reported_even_if_the_fit_hides_it(kind, touched_head, seeds):
    for seed in seeds:
        moving, fixed, rng = touched_head(seed)
        moving[:, rng.integers(3)] *= -1
        assert faults(moving, fixed, kind) == [("mirrored", ALL)]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scale", [1 / 1000, 1 / 25.4, 0.1, 0.9, 1.05, 10, 1000])
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


def test_each_of_several_faults_is_reported(touched_head):
    moving, fixed, _ = touched_head(3)
    moving[[2, 9]] = moving[[9, 2]]
    moving[5] += [0, 0, 30]
    found = faults(moving * [1e-3, 1e-3, -1e-3], fixed, "affine")
    assert found == [
        ("scale", ALL),
        ("mirrored", ALL),
        ("order", labels(2, 9)),
        ("outlier", labels(5)),
    ]


def test_flat_sets_are_reported_if_they_make_the_fit_uncertain(touched_head):
    _, fixed, _ = touched_head(4)
    assert [code for code, _ in faults(fixed * [1, 1, 0.01], fixed * [1, 1, 0.01], "affine")] == [
        "nearly-coplanar"
    ] * 2
    assert faults(fixed * [1, 1, 0.01], fixed * [1, 1, 0.01], "rigid") == []
    thin = fixed * [1, 0.01, 0.01]
    assert [code for code, _ in faults(thin, thin)] == ["nearly-collinear"] * 2


def test_warnings_name_the_points_and_the_improvement(touched_head):
    moving, fixed, _ = touched_head(0)
    moving[[3, 10]] = moving[[10, 3]]
    (warning,) = register(moving, fixed).warnings
    assert warning.message.startswith("Points 4 and 11 seem to be exchanged")
    assert warning.message.endswith("mm).")
    assert record_to_json(warning) == {
        "code": "order",
        "points": ["4", "11"],
        "message": warning.message,
    }
