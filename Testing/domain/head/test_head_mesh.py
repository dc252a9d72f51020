"""The head's surface: file, topology, nearest points, visibility, and a shift of the skin."""

import numpy as np
import pytest
import trimesh

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, hides, nearest_on_mesh, read_head_mesh, write_head_mesh
from rastrainer.head.trial_head import SkinShift
from rastrainer.head.triangle_tree import FollowedPoints
from Testing.domain.head.spheres import sphere_mesh
from Testing.domain.registration.traces import colin27


@pytest.fixture
def head_file(tmp_path):
    path = tmp_path / "head.ply"
    write_head_mesh(path, sphere_mesh(2))
    return path


def test_topology_and_center_agree_with_trimesh():
    torus = trimesh.creation.torus(80, 30).apply_translation([5, -12, 40])
    mesh = HeadMesh(np.array(torus.vertices), np.array(torus.faces))
    assert mesh.is_closed
    assert mesh.euler_characteristic == torus.euler_number == 0
    assert np.allclose(mesh.centroid, torus.center_mass)


@pytest.mark.parametrize(
    "broken",
    [
        pytest.param(lambda mesh: mesh.triangles[1:], id="a triangle is missing"),
        pytest.param(lambda mesh: np.vstack([mesh.triangles, mesh.triangles[:1]]), id="one twice"),
        pytest.param(
            lambda mesh: np.vstack([mesh.triangles[:1, ::-1], mesh.triangles[1:]]), id="one flipped"
        ),
    ],
)
def test_an_open_or_twisted_surface_is_not_closed(broken):
    mesh = sphere_mesh(2)
    assert mesh.is_closed
    assert not HeadMesh(mesh.vertices, broken(mesh)).is_closed


@pytest.mark.parametrize(
    ("spoil", "sentence"),
    [
        (
            lambda content: content.replace(b"SPACE=RAS", b"SPACE=IJK"),
            "whether it is in RAS or LPS",
        ),
        (lambda content: content.replace(b"comment SPACE=RAS\n", b""), "whether it is in RAS or"),
        (lambda content: content[:-4] + b"\xff\xff\xff\x7f", "not a polygon of its vertices"),
        (lambda content: _first_vertex(content, 1e9), "not within"),
    ],
)
def test_a_broken_mesh_is_refused_with_a_message(head_file, spoil, sentence):
    head_file.write_bytes(spoil(head_file.read_bytes()))
    with pytest.raises(InputError, match=sentence):
        read_head_mesh(head_file)


BOX = 100.0 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4]]


@pytest.mark.parametrize("name", ["vertex_indices", "vertex_index"])
@pytest.mark.parametrize("last", [[[1, 5, 7, 3]], [[1, 5, 7], [1, 7, 3]]], ids=["quads", "mixed"])
@pytest.mark.parametrize("space", ["RAS", "LPS"])
def test_a_mesh_with_polygons_and_colors_of_another_program_is_read(tmp_path, name, last, space):
    faces = [*QUADS, *last]
    shown = BOX * ([1, 1, 1] if space == "RAS" else [-1, -1, 1])
    lines = [f"{x} {y} {z} 255 0 {number}" for number, (x, y, z) in enumerate(shown)]
    lines += [" ".join(map(str, (len(face), *face))) for face in faces]
    path = tmp_path / "head.ply"
    path.write_text(
        f"ply\nformat ascii 1.0\ncomment SPACE={space}\nelement vertex 8\nproperty double x\n"
        "property double y\nproperty double z\nproperty uchar red\nproperty uchar green\n"
        f"property uchar blue\nelement face {len(faces)}\nproperty list uchar int {name}\n"
        "end_header\n" + "\n".join(lines)
    )
    mesh = read_head_mesh(path)
    assert mesh.is_closed
    assert len(mesh.triangles) == 12
    np.testing.assert_array_equal(mesh.vertices, BOX)
    np.testing.assert_allclose(mesh.centroid, 0.0, atol=1e-9)
    assert (mesh.triangle_normals @ mesh.vertices[mesh.triangles[:, 0]].T).diagonal().min() > 0


def _first_vertex(content, value):
    header_end = content.index(b"end_header\n") + len(b"end_header\n")
    return content[:header_end] + np.array([value], "<f4").tobytes() + content[header_end + 4 :]


def test_nearest_points_and_visibility_agree_with_trimesh():
    mesh, eye = sphere_mesh(3), np.array([100.0, 400.0, 300.0])
    points = np.random.default_rng(8).uniform(-140, 140, (200, 3))
    other = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    positions, distances, _ = trimesh.proximity.closest_point(other, points)
    found = [nearest_on_mesh(mesh, point) for point in points]
    assert np.allclose([nearest.distance for nearest in found], distances, atol=1e-9)
    assert np.allclose([nearest.position for nearest in found], positions, atol=1e-6)
    directions = points - eye
    hits, rays, _ = other.ray.intersects_location(np.tile(eye, (200, 1)), directions)
    before = np.linalg.norm(hits - eye, axis=1) < np.linalg.norm(directions, axis=1)[rays] - 1.0
    expected = np.isin(np.arange(200), rays[before])
    assert [hides(mesh, eye, point) for point in points] == expected.tolist()


def test_a_shift_has_the_requested_size_is_smooth_and_vanishes_at_the_base():
    head = colin27()
    high = head.vertices[head.vertices[:, 2] > head.vertices[:, 2].min() + 30.0][::40]
    squares = [np.sum(SkinShift(2.0, seed).moved(high, head) ** 2, axis=1) for seed in range(60)]
    assert np.sqrt(np.mean(squares)) == pytest.approx(2.0, abs=0.15)
    shift = SkinShift(2.0, 7)
    moved, beside = shift.moved(high, head), shift.moved(high + np.array([3.0, 0.0, 0.0]), head)
    assert np.linalg.norm(moved - beside, axis=1).max() < 0.5
    assert np.array_equal(moved, SkinShift(2.0, 7).moved(high, head))
    assert not np.allclose(moved, SkinShift(2.0, 8).moved(high, head))
    assert not shift.moved(np.array([[0.0, 0.0, head.vertices[:, 2].min()]]), head).any()


def test_by_default_nothing_moves_and_an_indentation_points_inward():
    head, rows = colin27(), slice(0, 2000, 50)
    points, normals = head.vertices[rows], head.vertex_normals[rows]
    assert np.array_equal(SkinShift().touched(points, normals, head), points)
    pressed = SkinShift(indentation_mm=1.5).touched(points, normals, head)
    assert np.allclose(pressed, points - 1.5 * normals)
    with pytest.raises(InputError, match="0 to 20 mm"):
        SkinShift(-1.0)


@pytest.fixture(scope="module")
def head():
    """A sphere with bumps as small as a nose and an ear."""
    ball = sphere_mesh(4)
    bumps = 1.0 + 0.1 * np.cos(ball.vertices / 6.0).prod(axis=1)
    return HeadMesh(ball.vertices * bumps[:, None], ball.triangles)


@pytest.mark.parametrize("off_mm", [0.5, 60.0])
def test_nearest_points_of_many_match_those_found_one_by_one(head, off_mm):
    random = np.random.default_rng(1)
    points = head.vertices[random.integers(0, len(head.vertices), 25)]
    points = points + off_mm * random.normal(0.0, 1.0, points.shape)
    found = head.tree.nearest(points)
    singles = [nearest_on_mesh(head, point) for point in points]
    assert np.allclose(found.distances, [one.distance for one in singles], atol=1e-9)
    corners = head.vertices[head.triangles[found.triangles]]
    assert (found.positions >= corners.min(axis=1) - 1e-9).all()
    assert (found.positions <= corners.max(axis=1) + 1e-9).all()


def test_tracked_points_have_the_same_nearest_points_as_a_new_search(head):
    random = np.random.default_rng(2)
    points = head.vertices[random.integers(0, len(head.vertices), 60)] + random.normal(
        0, 3, (60, 3)
    )
    followed = FollowedPoints(head.tree, points, 0.0)
    assert np.array_equal(followed.nearest.positions, head.tree.nearest(points).positions)
    for step, size in enumerate((20.0, 3.0, 0.8, 0.5, 0.3, 0.01)):
        moves = random.normal(0.0, size, points.shape)
        points = points + moves
        # Some move farther than predicted.
        found = followed.move(points, 0.7 * np.linalg.norm(moves, axis=1))
        again = head.tree.nearest(points)
        assert np.allclose(found.distances, again.distances, atol=1e-12)
        assert np.allclose(found.positions, again.positions, atol=1e-9)
        kept = np.delete(np.arange(len(points)), step)
        followed.keep(kept)
        points = points[kept]
