"""Guidance while the skin is traced: where it leads, how long it stays, and what it gains."""

import numpy as np
import pytest

from rastrainer.protocol import MAX_TRACE_POINTS
from rastrainer.registration.surface_error import (
    COVERED_MM,
    DAB,
    TraceGuide,
    guided_vertices,
    nearest_traced_mm,
)
from Testing.domain.registration.drawing_hands import (
    EYE,
    TARGET,
    draw_by_guidance,
    expected_after,
)
from Testing.domain.registration.traces import colin27, random_walk


@pytest.fixture(scope="module")
def head():
    return colin27()


@pytest.fixture(scope="module")
def guide(head):
    return TraceGuide(head, TARGET, EYE)


@pytest.fixture
def nothing():
    return np.zeros((0, 3))


def around(place, count, away_mm=2.0):
    """So many points near a place."""
    return place + np.linspace(-away_mm, away_mm, count)[:, None] * np.ones(3) / np.sqrt(3.0)


def test_places_are_where_a_trainee_sees_and_reaches_the_skin_and_off_the_ears(head):
    rows = guided_vertices(head, EYE)
    places, normals = head.vertices[rows], head.vertex_normals[rows]
    assert len(rows) > 300
    toward = (EYE - places) / np.linalg.norm(EYE - places, axis=1, keepdims=True)
    assert np.einsum("ij,ij->i", normals, toward).min() > 0.5
    assert normals[:, 2].min() > -0.3
    assert places[:, 2].min() > head.vertices[:, 2].min() + 10.0
    ears = (np.abs(places[:, 0]) > 82.0) & (places[:, 1] < 0.0) & (places[:, 2] < 0.0)
    assert not ears.any()


def test_a_place_stays_until_a_centimeter_is_drawn_there(guide, nothing):
    first = guide.next_place(nothing, is_drawing=False)
    begun = around(first.position, DAB - 1)
    assert guide.next_place(begun, is_drawing=True) is first
    done = around(first.position, DAB)
    done[: DAB - 1] = begun
    then = guide.next_place(done, is_drawing=True)
    assert np.linalg.norm(then.position - first.position) > COVERED_MM


def test_a_stroke_elsewhere_moves_the_place_only_when_it_ends(guide, nothing):
    first = guide.next_place(nothing, is_drawing=False)
    elsewhere = around(np.array([0.0, 46.0, 80.0]), 40, 20.0)
    assert guide.next_place(elsewhere, is_drawing=True) is first
    then = guide.next_place(elsewhere, is_drawing=False)
    assert then is not first
    assert np.linalg.norm(then.position - elsewhere, axis=1).min() > COVERED_MM


def test_after_an_undone_stroke_the_place_is_as_before_it(guide, nothing):
    first = guide.next_place(nothing, is_drawing=False)
    guide.next_place(around(first.position, 3 * DAB), is_drawing=False)
    again = guide.next_place(nothing, is_drawing=False)
    assert np.array_equal(again.position, first.position)


def test_a_full_trace_has_no_next_place(guide, head):
    full = head.vertices[guided_vertices(head, EYE)][np.arange(MAX_TRACE_POINTS) % 300]
    assert guide.next_place(full, is_drawing=False) is None


def test_the_distance_to_the_trace_is_the_same_point_by_point(head):
    trace, vertices = head.vertices[[100, 5000, 9000]], head.vertices[::7]
    away = np.linalg.norm(vertices[:, None] - trace, axis=2).min(axis=1)
    known = nearest_traced_mm(vertices, trace[:1])
    assert np.allclose(nearest_traced_mm(vertices, trace[1:], known), away, atol=1e-5)
    assert np.isinf(nearest_traced_mm(vertices, trace[:0])).all()


@pytest.mark.parametrize("hands", [1, pytest.param(4, marks=pytest.mark.soak)])
def test_guidance_more_than_halves_the_expected_error_of_drawing_at_random(head, guide, hands):
    front, count = (head.vertices[:, 1] > 0.0) & (head.vertices[:, 2] > -60.0), 100
    walks = [random_walk(head, front, np.random.default_rng(seed), count) for seed in range(4)]
    at_random = [expected_after(head, head.vertices[walk]) for walk in walks]
    guided = [
        expected_after(head, draw_by_guidance(head, guide, seed, count)) for seed in range(hands)
    ]
    assert max(guided) < 0.5 * min(at_random)
