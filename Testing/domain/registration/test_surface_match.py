"""A trace over the skin is registered to the head's surface, and its limits are reported."""

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.registration.surface_match import match_surface
from Testing.domain.registration import traces


@pytest.fixture(scope="module")
def head():
    return traces.colin27()


@pytest.fixture
def face(head):
    """Make (trace, start, pose) of a face of 200 points."""

    def make(seed, noise_mm=0.5, where="face"):
        random = np.random.default_rng(seed)
        pose = traces.head_pose(random)
        trace = traces.traced(head, traces.places(head, where), random, pose, noise_mm)
        return trace, traces.coarse_start(random, pose), pose

    return make


def codes(match):
    return {warning.code for warning in match.warnings}


def test_with_noise_the_residual_is_the_noise_and_the_error_small(head, face):
    trace, start, pose = face(4, 0.5)
    match = match_surface(trace, head, start)
    assert 0.4 < match.rms_mm < 0.6
    assert traces.error_at_center(match.matrix, pose, head) < 0.5
    placed = transforms.apply(match.matrix, trace)
    assert np.allclose(placed, match.places_mm)
    feet = placed - match.residuals_mm[:, None] * match.normals
    assert np.allclose(head.skin.tree.nearest(feet).distances, 0.0, atol=1e-6)
    assert np.allclose(np.linalg.norm(match.normals, axis=1), 1.0)


def test_points_far_off_do_not_count_and_are_named(head, face):
    trace, start, pose = face(6)
    center = transforms.apply(pose, head.middle)
    trace[::10] += 0.15 * (trace[::10] - center)
    match = match_surface(trace, head, start)
    assert traces.error_at_center(match.matrix, pose, head) < 0.5
    assert not match.is_inlier[::10].any()
    (warning,) = [one for one in match.warnings if one.code == "far-points"]
    assert set(map(str, range(1, 201, 10))) == set(warning.points)


def test_a_trace_with_half_of_its_points_in_the_air_is_reported(head, face):
    trace, start, _ = face(7)
    trace[:70] += np.random.default_rng(7).uniform(8.0, 20.0, (70, 3))
    assert "few-inliers" in codes(match_surface(trace, head, start))


def test_a_trace_on_the_crown_alone_is_reported_as_sliding_however_small_its_residual(head, face):
    trace, start, _ = face(8, 0.1, "crown")
    match = match_surface(trace, head, start, starts=1)
    (warning,) = [one for one in match.warnings if one.code == "slides"]
    assert match.rms_mm < 0.2
    assert match.slide.distance_mm > 3.0
    assert match.slide.way in warning.message
    trace, start, _ = face(8, 0.1)
    assert "slides" not in codes(match_surface(trace, head, start, starts=1))


def test_a_few_points_far_from_a_dense_trace_do_not_hide_that_it_slides(head):
    random = np.random.default_rng(16)
    pose, crown = traces.head_pose(random), traces.places(head, "crown")
    dense = traces.traced(head, crown, random, pose, 0.5, 300)
    away = np.linalg.norm(head.vertices - head.vertices[crown].mean(axis=0), axis=1)
    aside = np.flatnonzero((away > 60.0) & (away < 80.0))
    far = traces.traced(head, aside, random, pose, 0.5, 3)
    match = match_surface(
        np.vstack([dense, far]), head, traces.coarse_start(random, pose), starts=1
    )
    assert "slides" in codes(match)


def test_a_trace_of_another_head_is_reported(head, face):
    trace, start, _ = face(9)
    shape = (head.vertices - head.middle) * [0.85, 1.12, 0.95] + head.middle
    other = HeadMesh(shape, head.triangles)
    assert "poor-fit" in codes(match_surface(trace, other, start, starts=1))


@pytest.mark.parametrize(
    ("spoil", "sentence"),
    [
        (lambda t: t[:29], "needs 30 to"),
        (lambda t: t[0] + np.random.default_rng(0).normal(0, 2, (60, 3)), "in one place"),
        (lambda t: t + 400.0, "mm off the head"),
    ],
    ids=["few", "one place", "far off"],
)
def test_an_unusable_trace_is_refused_with_a_message(head, face, spoil, sentence):
    trace, start, _ = face(13)
    with pytest.raises(InputError, match=sentence):
        match_surface(spoil(trace), head, start)


def test_an_open_surface_and_one_in_meters_are_refused_with_a_message(head, face):
    trace, start, _ = face(14)
    with pytest.raises(InputError, match="holes"):
        match_surface(trace, HeadMesh(head.vertices, head.triangles[1:]), start)
    with pytest.raises(InputError, match="in millimeters"):
        match_surface(trace, HeadMesh(head.vertices / 1000.0, head.triangles), start)
