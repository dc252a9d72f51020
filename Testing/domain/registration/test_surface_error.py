"""The expected error of a surface match, and guidance to where more points help most."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.registration.surface_error import (
    COVERED_MM,
    DAB,
    TraceGuide,
    guided_vertices,
    knowledge_so_far,
    next_best_place,
)
from Testing.domain.registration.drawing_hands import EYE, TARGET, expected_mm
from Testing.domain.registration.traces import colin27, places

NOISE_MM = 0.5
ASIDE = np.array([[10.0, -20.0, 5.0], [-25.0, 10.0, 20.0], [25.0, -30.0, -10.0]])
"""Distance of targets from the middle of the head, mm."""


@pytest.fixture(scope="module")
def head():
    return colin27()


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


@pytest.fixture(scope="module")
def guide(head):
    return TraceGuide(head, TARGET, EYE)


@pytest.fixture
def nothing():
    return np.zeros((0, 3))


def around(place, count, away_mm=2.0):
    """A number of points near a place."""
    return place + np.linspace(-away_mm, away_mm, count)[:, None] * np.ones(3) / np.sqrt(3.0)


def test_suggested_places_are_visible_reachable_skin_away_from_the_ears(head):
    rows = guided_vertices(head, EYE)
    places, normals = head.vertices[rows], head.vertex_normals[rows]
    assert len(rows) > 300
    toward = (EYE - places) / np.linalg.norm(EYE - places, axis=1, keepdims=True)
    assert np.einsum("ij,ij->i", normals, toward).min() > 0.5
    assert normals[:, 2].min() > -0.3
    assert places[:, 2].min() > head.vertices[:, 2].min() + 10.0
    ears = (np.abs(places[:, 0]) > 82.0) & (places[:, 1] < 0.0) & (places[:, 2] < 0.0)
    assert not ears.any()


def test_a_suggested_place_stays_until_a_centimeter_is_traced_there(guide, nothing):
    first = guide.next_place(nothing, is_drawing=False)
    begun = around(first.position, DAB - 1)
    assert guide.next_place(begun, is_drawing=True) is first
    done = around(first.position, DAB)
    done[: DAB - 1] = begun
    then = guide.next_place(done, is_drawing=True)
    assert np.linalg.norm(then.position - first.position) > COVERED_MM
