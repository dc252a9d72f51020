"""Tasks proposed on a sphere the size of a head: as the plans require, for any seed."""

import numpy as np
import pytest
import trimesh

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
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
TARGET = np.zeros(3)


@pytest.fixture(scope="module")
def mesh():
    return sphere_mesh()


@pytest.fixture(scope="module")
def places(mesh):
    vertices = smooth_places(mesh, 12.0)
    return places_seen_from(mesh, mesh.vertices[vertices], mesh.vertex_normals[vertices], EYE)


@pytest.fixture(scope="module")
def proposer(mesh, places):
    return TaskProposer(SurfaceGraph(mesh), places, EYE, TARGET)


def test_the_first_task_is_the_easiest_of_many_on_request(proposer):
    usual, easy = (
        proposer.propose_rising(PLANS[1:2], seed=1, begins_easy=begins_easy)[0]
        for begins_easy in (False, True)
    )
    assert easy.complexity.index < usual.complexity.index


def test_positions_that_prove_unusable_are_replaced(mesh, places, proposer):
    plan = PLANS[2]
    useless = proposer.propose(plan, 5).fiducials[:4]
    counts = []

    def usable(positions):
        counts.append(len(positions))
        return ~(positions[:, None] == useless[None]).all(axis=2).any(axis=1)

    picky = TaskProposer(SurfaceGraph(mesh), places, EYE, TARGET, usable=usable)
    found = picky.propose(plan, 5)
    assert usable(found.fiducials).all()
    assert found.complexity.hidden_points == plan.hidden
    assert 2 < len(counts) < 8
    assert np.array_equal(picky.propose(plan, 5).fiducials, found.fiducials)


def test_the_same_seed_proposes_the_same_task(proposer):
    first, again = (proposer.propose(PLANS[2], 5) for _ in range(2))
    assert np.array_equal(first.fiducials, again.fiducials)
    assert not np.array_equal(first.fiducials, proposer.propose(PLANS[2], 6).fiducials)


def test_a_head_without_room_for_a_task_is_refused_with_a_message(mesh, places):
    few = type(places)(*(values[:10] for values in vars(places).values()))
    with pytest.raises(InputError, match="no room for the fiducials of Task 1"):
        TaskProposer(SurfaceGraph(mesh), few, EYE, TARGET).propose(PLANS[1], 1)


def test_no_fiducial_is_placed_near_an_edge():
    drum = trimesh.creation.cylinder(radius=80.0, height=120.0, sections=96).subdivide_to_size(6.0)
    mesh = HeadMesh(np.array(drum.vertices), np.array(drum.faces))
    places = mesh.vertices[smooth_places(mesh, 8.0)]
    to_edge = np.hypot(80.0 - np.hypot(*places[:, :2].T), 60.0 - places[:, 2])
    assert len(places) > 100
    assert to_edge.min() > 6.0


def ways_of(points):
    points = np.asarray(points, dtype=float)
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    lengths = np.linalg.norm(points[:, None] - points[None], axis=2)
    return transitions_between(points, normals, lengths)


@pytest.mark.parametrize("crossings", [1, 4, 9])
def test_the_order_changes_sides_as_often_as_requested(crossings):
    points = np.random.default_rng(1).uniform(-80, 80, (15, 3)) * [1, 1, 0]
    by_side = np.argsort(points[:, 0]).tolist()
    sides = [by_side[:8], by_side[8:]]
    order = crossing_order(ways_of(points), sides, crossings)
    assert sorted(order) == list(range(15))
    on_first = [place in sides[0] for place in order]
    assert np.count_nonzero(np.diff(on_first)) == crossings
