"""The head's surface: its file and topology, nearest points, normals and visibility."""

import numpy as np
import pytest
import trimesh

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, hides, nearest_on_mesh, read_head_mesh, write_head_mesh
from Testing.domain.head.spheres import sphere_mesh


@pytest.fixture
def head_file(tmp_path):
    path = tmp_path / "head.ply"
    write_head_mesh(path, sphere_mesh(2))
    return path


def test_other_programs_read_the_file_as_the_same_mesh(head_file):
    mesh = read_head_mesh(head_file)
    other = trimesh.load(head_file, process=False)
    assert np.array_equal(other.vertices, mesh.vertices)
    assert np.array_equal(other.faces, mesh.triangles)


def test_topology_and_center_agree_with_trimesh():
    torus = trimesh.creation.torus(80, 30).apply_translation([5, -12, 40])
    mesh = HeadMesh(np.array(torus.vertices), np.array(torus.faces))
    assert mesh.is_closed
    assert mesh.euler_characteristic == torus.euler_number == 0
    assert np.allclose(mesh.centroid, torus.center_mass)


def test_normals_of_a_sphere_point_away_from_its_center():
    mesh = sphere_mesh()
    outward = mesh.vertices / np.linalg.norm(mesh.vertices, axis=1, keepdims=True)
    assert np.einsum("ij,ij->i", mesh.vertex_normals, outward).min() > 0.9995
    centers = mesh.vertices[mesh.triangles].mean(axis=1)
    outward = centers / np.linalg.norm(centers, axis=1)[:, None]
    assert np.einsum("ij,ij->i", mesh.triangle_normals, outward).min() > 0.999


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


def test_a_missing_mesh_is_named(tmp_path):
    with pytest.raises(InputError, match=r"none\.ply does not exist"):
        read_head_mesh(tmp_path / "none.ply")


@pytest.mark.parametrize(
    ("spoil", "sentence"),
    [
        (lambda content: bytes(len(content)), "must be a PLY"),
        (
            lambda content: content.replace(b"SPACE=RAS", b"SPACE=IJK"),
            "whether it is in RAS or LPS",
        ),
        (lambda content: content.replace(b"comment SPACE=RAS\n", b""), "whether it is in RAS or"),
        (lambda content: content.replace(b"float x", b"float a"), "must have vertices x, y and z"),
        (lambda content: content[:-4] + b"\xff\xff\xff\x7f", "not a polygon of its vertices"),
        (lambda content: _first_vertex(content, np.nan), "not within"),
        (lambda content: _first_vertex(content, 1e9), "not within"),
        (lambda content: content.replace(b"face 320", b"face 3999999"), "cut short"),
        (lambda content: content.replace(b"vertex 162", b"vertex 3999999"), "cut short"),
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


def test_the_nearest_points_agree_with_trimesh():
    mesh = sphere_mesh(3)
    points = np.random.default_rng(3).uniform(-150, 150, (200, 3))
    other = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    positions, distances, _ = trimesh.proximity.closest_point(other, points)
    found = [nearest_on_mesh(mesh, point) for point in points]
    assert np.allclose([nearest.distance for nearest in found], distances, atol=1e-9)
    assert np.allclose([nearest.position for nearest in found], positions, atol=1e-6)


def test_visibility_agrees_with_trimesh():
    rng = np.random.default_rng(8)
    mesh, eye = sphere_mesh(3), np.array([100.0, 400.0, 300.0])
    points = rng.uniform(-140, 140, (200, 3))
    other = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    directions = points - eye
    hits, rays, _ = other.ray.intersects_location(np.tile(eye, (200, 1)), directions)
    before = np.linalg.norm(hits - eye, axis=1) < np.linalg.norm(directions, axis=1)[rays] - 1.0
    expected = np.isin(np.arange(200), rays[before])
    assert [hides(mesh, eye, point) for point in points] == expected.tolist()
