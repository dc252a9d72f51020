"""Cases are repeatable and near the limit, and each fault shows what a surgeon would see of it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.decision.drill_record import Fault
from rastrainer.head.mesh import nearest_on_mesh
from rastrainer.protocol import RegistrationMethod
from rastrainer.registration.fits import RIGID, fit
from rastrainer.scenario.points import NOSE_TIP
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.decision.cases import (
    BACK,
    LIMIT_MM,
    MOST_ERROR,
    NEVER_SOUND,
    CaseMaker,
)

SEEDS = range(4)
QUICK = [fault for fault in Fault if fault is not Fault.SLID_TRACE]


@cache
def maker():
    return CaseMaker(load_scenario(asset_path("scenarios", "colin27")))


@cache
def case(seed, fault):
    return maker().case(seed, fault)


def cases(fault):
    return [case(seed, fault) for seed in SEEDS]


def by_touch(fault):
    return [each for each in cases(fault) if each.method is RegistrationMethod.FIDUCIALS]


def offsets(each):
    """Return from each checkable place to the tip, (n, 3), mm, in the axes of the head."""
    axes = each.head_to_world[:3, :3]
    return np.array(
        [(each.tip_for(place) - each.truly(place)) @ axes for place in each.places.values()]
    )


def beside(each):
    return np.linalg.norm(offsets(each), axis=1)


@pytest.mark.parametrize("fault", QUICK)
def test_the_true_error_is_how_far_the_tip_misses_the_target(fault):
    for each in cases(fault):
        # Not by `tip_for`: the target lies deep, where no skin shifts.
        goes = transforms.apply(np.linalg.inv(each.registration), each.target_mm)
        target = maker().scenario.target.position_ras
        belongs = transforms.apply(maker().scenario.head_to_world, np.array(target))
        assert each.true_error_mm == pytest.approx(np.linalg.norm(goes - belongs), abs=1e-6)
        assert np.allclose(each.tip_for(each.target_mm), goes)


@pytest.mark.parametrize("fault", QUICK)
def test_residuals_are_those_of_the_shown_points(fault):
    for each in by_touch(fault):
        assert np.allclose(
            each.residuals_mm, np.linalg.norm(each.registered_mm - each.fixed_mm, axis=1)
        )
        assert each.residual_mm == pytest.approx(np.sqrt(np.mean(each.residuals_mm**2)))
        assert len(each.labels) == len(each.fixed_mm)
        # A rigid fit cannot be made better by another rigid motion.
        assert np.allclose(fit(each.registered_mm, each.fixed_mm, RIGID), np.eye(4), atol=1e-6)


@pytest.mark.parametrize("fault", [fault for fault in QUICK if fault is not Fault.NONE])
def test_a_fault_is_small_in_some_cases_and_large_in_others_near_the_limit(fault):
    errors = [maker().guess_mm(seed, fault) for seed in range(16)]
    assert max(errors) > LIMIT_MM
    assert np.median(errors) < MOST_ERROR * LIMIT_MM
    if fault in NEVER_SOUND:
        assert not any(each.is_sound for each in cases(fault))
    else:
        assert min(errors) <= LIMIT_MM


def test_the_tip_of_a_bent_tool_is_off_alike_at_all_places():
    for each in by_touch(Fault.BENT_TOOL):
        spread = offsets(each) - offsets(each).mean(axis=0)
        # The touches scatter.
        usual = [offsets(other) for other in by_touch(Fault.NONE)]
        assert np.sqrt(np.mean(spread**2)) < 4.0 * max(np.sqrt(np.mean(o**2)) for o in usual)
    largest = max(by_touch(Fault.BENT_TOOL), key=lambda each: each.true_error_mm)
    off = offsets(largest)
    assert np.linalg.norm(off.mean(axis=0)) > 2.0 * np.linalg.norm(off.std(axis=0))


def test_mirrored_images_take_the_tip_to_the_other_side_of_the_head():
    side = np.array([1.0, 0.0, 0.0])
    for each in cases(Fault.MIRRORED):
        axes = each.head_to_world[:3, :3]
        left, right = (each.tip_for(each.places[name]) for name in ("Left ear", "Right ear"))
        assert (right - left) @ axes @ side < -100.0
        assert beside(each).max() > 100.0
        assert each.residual_mm < 6.0


def test_fiducials_far_from_the_target_lie_together():
    for each in cases(Fault.FAR_FIDUCIALS):
        center = each.fixed_mm.mean(axis=0)
        reach = np.linalg.norm(each.fixed_mm - center, axis=1).max()
        assert reach < np.linalg.norm(center - each.target_mm)
        assert each.expected.expected_mm > each.residual_mm / np.sqrt(len(each.labels))


def test_two_exchanged_labels_stand_out_and_fit_when_exchanged_back():
    for each in cases(Fault.SWAPPED):
        order = np.arange(len(each.labels))
        pairs = [(a, b) for a in order for b in order if a < b]
        fits = {}
        for a, b in pairs:
            changed = order.copy()
            changed[[a, b]] = b, a
            moved = each.registered_mm[changed]
            there = transforms.apply(fit(moved, each.fixed_mm, RIGID), moved)
            fits[a, b] = np.sqrt(np.mean(np.sum((there - each.fixed_mm) ** 2, axis=1)))
        assert min(fits.values()) < 6.0 < each.residual_mm


def test_where_only_the_skin_has_shifted_the_tip_meets_the_skin_that_was_registered():
    for each in by_touch(Fault.SHIFTED_SKIN):
        near = [name for name in each.places if name.startswith("fiducial")]
        seen = [np.linalg.norm(each.tip_for(p) - each.truly(p)) for p in map(each.places.get, near)]
        assert np.mean(seen) < max(3.0, each.true_error_mm + each.residual_mm)
        # The tip that is held where the robot goes is shown at the place itself.
        place = each.places[NOSE_TIP]
        assert np.allclose(each.in_images(each.tip_for(place)), place, atol=0.05)


def test_a_trace_on_the_crown_slides_with_a_small_residual():
    each = case(0, Fault.SLID_TRACE)
    head = nearest_on_mesh(maker().mesh, each.trace_mm.mean(axis=0)).position
    assert head[2] > maker().mesh.vertices[:, 2].max() - 60.0
    assert each.residual_mm < 2.5
    assert each.true_error_mm > 0.3
    assert beside(each).max() > each.true_error_mm


def test_a_head_without_landmarks_has_cases():
    without = CaseMaker(replace(maker().scenario, landmarks=()))
    for fault in (Fault.SWAPPED, Fault.MIRRORED, Fault.SLID_TRACE):
        each = without.case(4, fault)
        assert each.true_error_mm > 0.0
        assert {NOSE_TIP, BACK} <= set(each.places)
