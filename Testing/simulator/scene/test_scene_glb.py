import numpy as np
import pytest
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (the importer makes actors)
from vtkmodules.vtkIOImport import vtkGLTFImporter

from rastrainer.head.mesh import read_head_mesh
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.meshes import load_meshes
from rastrainer_simulator.scene.scene_glb import scene_glb
from Testing.simulator.scene.glb_reader import Glb

MOVED = [*(f"link_{joint}" for joint in range(8)), "tool", "head", "stand"]
AT_THE_TOOL = {"guide", "axis", "drill", "electrode"}
STANDING = ["table", "floor", "room"]


@pytest.fixture(scope="module")
def content(setup) -> bytes:
    return scene_glb(setup.scenario, setup.robot, setup.scenario.task("task-3"))


@pytest.fixture(scope="module")
def glb(content) -> Glb:
    return Glb(content)


def test_the_scene_is_small_enough_for_a_headset(content, glb):
    primitives = glb.primitives("world")
    assert len(content) <= 5_000_000
    assert sum(len(triangles) for _, _, triangles, _ in primitives) <= 150_000
    assert len(primitives) <= 100, "each is a draw call"


def test_moving_parts_are_children_of_the_root_which_turns_z_up_into_y_up(glb):
    table, *others = STANDING
    assert glb.children("world") == [*MOVED, table, "plan", *others]
    assert glb.parent("world") is None
    turned = glb.matrix("world")
    assert turned @ [0, 0, 1, 1] == pytest.approx([0, 1, 0, 1]), "up"
    assert turned @ [1, 0, 0, 1] == pytest.approx([1, 0, 0, 1]), "forward"
    assert np.linalg.det(turned[:3, :3]) == pytest.approx(1.0)
    for name in glb.children("world"):
        assert glb.matrix(name) == pytest.approx(np.eye(4))


def test_the_links_coincide_with_the_robots_meshes(glb, setup):
    """Posed by the stream, each node covers what the URDF's meshes cover."""
    links = make_kinematics(setup.robot).links(np.array(setup.robot.home))
    expected: dict[str, list[np.ndarray]] = {}
    poses = {}
    for link in setup.robot.links:
        name = f"link_{link.joint}" if link.name[-1].isdigit() else "tool"
        poses[name] = links[setup.robot.tip.name] if name == "tool" else links[link.name]
        for mesh, _ in load_meshes(setup.robot).get(link.name, ()):
            vertices = mesh.vertices @ links[link.name][:3, :3].T + links[link.name][:3, 3]
            expected.setdefault(name, []).append(vertices)
    assert set(expected) == {*MOVED} - {"head", "stand"}
    for name, parts in expected.items():
        shown = [child for child in glb.children(name) if child not in AT_THE_TOOL]
        vertices = np.concatenate([glb.vertices(child) for child in shown or [name]])
        posed = vertices @ poses[name][:3, :3].T + poses[name][:3, 3]
        whole = np.concatenate(parts)
        assert posed.min(axis=0) == pytest.approx(whole.min(axis=0), abs=1e-5)
        assert posed.max(axis=0) == pytest.approx(whole.max(axis=0), abs=1e-5)


def test_triangle_winding_agrees_with_the_outward_normals(glb):
    for vertices, normals, triangles, _ in glb.primitives("world"):
        assert np.isfinite(vertices).all()
        assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-3)
        a, b, c = (vertices[triangles[:, corner]].astype(float) for corner in range(3))
        facing = np.cross(b - a, c - a)
        size = np.linalg.norm(facing, axis=1)
        meant = normals[triangles].sum(axis=1)
        agreeing = np.einsum("ij,ij->i", facing, meant) > 0
        assert size[agreeing].sum() > 0.999 * size.sum(), "but for slivers"


def test_vtk_reads_the_scene(content, glb, tmp_path):
    path = tmp_path / "scene.glb"
    path.write_bytes(content)
    importer = vtkGLTFImporter()
    importer.SetFileName(str(path))
    importer.Update()
    actors = importer.GetRenderer().GetActors()
    assert actors.GetNumberOfItems() == len(glb.primitives("world"))
    count = sum(
        actors.GetItemAsObject(index).GetMapper().GetInput().GetNumberOfCells()
        for index in range(actors.GetNumberOfItems())
    )
    assert count == sum(len(part[2]) for part in glb.primitives("world"))


def test_the_no_go_structures_are_placed_as_planned_and_transparent(glb, scenario):
    paths = {each.file for procedure in scenario.procedures for each in procedure.no_go}
    assert set(glb.children("plan")) == {f"no_go_{path.stem}" for path in paths}
    for path in paths:
        vertices = glb.vertices(f"no_go_{path.stem}")
        mesh = read_head_mesh(path)
        assert vertices.min(axis=0) == pytest.approx(mesh.vertices.min(axis=0) / 1000, abs=1e-6)
    (material,) = [each for each in glb.json["materials"] if each["name"] == "no_go"]
    assert material["alphaMode"] == "BLEND"
    assert material["pbrMetallicRoughness"]["baseColorFactor"][3] < 1.0
