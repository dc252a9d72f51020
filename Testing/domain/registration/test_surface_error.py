"""The expected error of a surface match against the true one, and the next place."""

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.registration.surface_error import (
    DAB,
    knowledge_of,
    knowledge_so_far,
    next_best_place,
    surface_target_error,
)
from rastrainer.registration.surface_match import match_surface
from rastrainer.registration.target_error import COMMON_BIAS_SD_MM
from Testing.domain.registration.drawing_hands import expected_mm
from Testing.domain.registration.traces import (
    coarse_start,
    colin27,
    head_pose,
    places,
    traced,
)
from Testing.simulator.authoring.heads import deformed, small

NOISE_MM = 0.5
ASIDE = np.array([[10.0, -20.0, 5.0], [-25.0, 10.0, 20.0], [25.0, -30.0, -10.0]])
"""Of targets, from the middle of the head, mm."""


@pytest.fixture(scope="module")
def head():
    return colin27()


def trial(head, seed, tip_sd_mm=0.0):
    """The match of a trace of 150 points on the face, and the true error at the first target."""
    random = np.random.default_rng(seed)
    pose = head_pose(random)
    trace = traced(head, places(head, "face"), random, pose, NOISE_MM, 150)
    trace = trace + random.normal(0.0, tip_sd_mm, 3)
    match = match_surface(trace, head, coarse_start(random, pose, 1.0, 1.0), starts=1)
    target = head.middle + ASIDE[0]
    return match, float(np.linalg.norm(transforms.apply(match.matrix @ pose, target) - target))


def coverage(head, trials, common_bias_sd_mm, first_seed=0):
    """The share of trials whose error is in its interval; true and expected RMS error."""
    target, inside, errors, expected = head.middle + ASIDE[0], 0, [], []
    for seed in range(first_seed, first_seed + trials):
        match, error = trial(head, seed, common_bias_sd_mm)
        knowledge = knowledge_of(match)
        found = surface_target_error(knowledge, target, common_bias_sd_mm=common_bias_sd_mm)
        inside += found.interval_mm[0] <= error <= found.interval_mm[1]
        errors.append(error)
        expected.append(found.expected_mm)
    rms = [float(np.sqrt(np.mean(np.square(each)))) for each in (errors, expected)]
    return inside / trials, *rms


def test_intervals_contain_the_true_error_and_its_size_is_foretold(head):
    share, true, expected = coverage(head, 12, 0.0)
    assert share >= 0.8
    assert expected == pytest.approx(true, rel=0.35)


@pytest.mark.soak
def test_of_2000_matches_93_to_97_percent_of_the_intervals_contain_the_error(head):
    share, true, expected = coverage(head, 2000, 0.0)
    assert 0.93 <= share <= 0.97
    assert expected == pytest.approx(true, rel=0.03)


@pytest.mark.soak
@pytest.mark.parametrize("make_head", [deformed, small])
def test_with_the_assumed_offset_they_do_so_on_other_heads_with_other_seeds(make_head):
    share, true, expected = coverage(make_head(), 1000, COMMON_BIAS_SD_MM, first_seed=5000)
    assert 0.93 <= share <= 0.97
    assert expected == pytest.approx(true, rel=0.05)


@pytest.mark.soak
def test_the_bootstrap_of_the_residuals_gives_the_same_error(head):
    match, _ = trial(head, 3)
    knowledge = knowledge_of(match)
    random, targets = np.random.default_rng(0), head.middle + ASIDE
    world = transforms.inverse(match.matrix)
    moved = []
    for _ in range(30):
        off = random.normal(0.0, knowledge.noise_mm, (150, 1)) * match.normals
        trace = transforms.apply(world, match.nearest_mm + off)
        again = match_surface(trace, head, match.matrix, starts=1)
        moved.append(transforms.apply(again.matrix @ world, targets) - targets)
    spread = np.sqrt(np.mean(np.sum(np.square(moved), axis=2), axis=0))
    assert np.allclose(expected_mm(knowledge, targets), spread, rtol=0.35)


def test_an_offset_that_all_points_share_adds_to_the_error(head):
    match, _ = trial(head, 4)
    alone, shared = (
        surface_target_error(knowledge_of(match), head.middle, common_bias_sd_mm=bias).expected_mm
        for bias in (0.0, 2.0)
    )
    assert shared**2 == pytest.approx(alone**2 + 12.0)


def test_the_expected_error_grows_away_from_the_trace(head):
    match, _ = trial(head, 5)
    over_head = expected_mm(knowledge_of(match), head.vertices)
    back = head.vertices[:, 1] < head.vertices[:, 1].min() + 20.0
    face = places(head, "face")
    assert over_head.shape == (len(head.vertices),)
    assert over_head[back].mean() > 1.2 * over_head[face].mean()


def expected_at_targets(head, rows):
    knowledge = knowledge_so_far(head.vertices[rows], head.vertex_normals[rows], head, NOISE_MM)
    return float(np.sqrt(np.mean(expected_mm(knowledge, head.middle + ASIDE) ** 2)))


def test_the_next_centimeter_gains_most_at_the_next_place(head):
    allowed = np.zeros(len(head.vertices), dtype=bool)
    allowed[places(head, "face")] = True
    rows = np.flatnonzero(allowed)[::200]
    knowledge = knowledge_so_far(head.vertices[rows], head.vertex_normals[rows], head, NOISE_MM)
    best = next_best_place(knowledge, head, head.middle + ASIDE, allowed)
    assert allowed[best.vertex]
    after, *elsewhere = (
        expected_at_targets(head, np.append(rows, [vertex] * DAB))
        for vertex in (best.vertex, *np.flatnonzero(allowed)[::40])
    )
    assert after < min(expected_at_targets(head, rows), *elsewhere) + 1e-9
    with pytest.raises(InputError, match="No place"):
        next_best_place(knowledge, head, head.middle + ASIDE, np.zeros_like(allowed))


def test_before_the_first_point_the_pose_is_as_open_as_landmarks_leave_it(head):
    knowledge = knowledge_so_far(np.zeros((0, 3)), np.zeros((0, 3)), head)
    (tre,) = expected_mm(knowledge, head.middle[None])
    assert tre == pytest.approx(10.0 * np.sqrt(3.0))
