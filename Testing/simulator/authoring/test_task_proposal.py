"""Proposed tasks: the order of their fiducials, and a head without room for them."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer_simulator.authoring.task_proposal import (
    PLANS,
    TaskProposer,
    places_seen_from,
    smooth_places,
)
from rastrainer_simulator.authoring.touch_order import (
    SurfaceGraph,
    crossing_order,
    transitions_between,
)
from Testing.domain.head.spheres import sphere_mesh

EYE = np.array([0.0, 600.0, 220.0])


def test_a_head_without_room_for_a_task_is_refused_with_a_message():
    mesh = sphere_mesh()
    vertices = smooth_places(mesh, 12.0)
    places = places_seen_from(mesh, mesh.vertices[vertices], mesh.vertex_normals[vertices], EYE)
    few = type(places)(*(values[:10] for values in vars(places).values()))
    with pytest.raises(InputError, match="no room for the fiducials of Task 1"):
        TaskProposer(SurfaceGraph(mesh), few, EYE, np.zeros(3)).propose(PLANS[1], 1)


def test_the_order_changes_sides_as_often_as_requested():
    crossings = 4
    points = np.random.default_rng(1).uniform(-80, 80, (15, 3)) * [1, 1, 0]
    lengths = np.linalg.norm(points[:, None] - points[None], axis=2)
    ways = transitions_between(points, np.tile([0.0, 0.0, 1.0], (15, 1)), lengths)
    by_side = np.argsort(points[:, 0]).tolist()
    sides = [by_side[:8], by_side[8:]]
    order = crossing_order(ways, sides, crossings)
    assert sorted(order) == list(range(15))
    on_first = [place in sides[0] for place in order]
    assert np.count_nonzero(np.diff(on_first)) == crossings
