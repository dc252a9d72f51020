import hashlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pinocchio
import pytest
import trimesh

from rastrainer.errors import InputError
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.robot.meshes import load_meshes
from rastrainer_simulator.robot.model import load_robot

ROBOT = asset_path("robots", "iiwa7")
FILES = sorted(ROBOT.glob("meshes/*/*.stl"))
LINK_ORIGINS_M = {  # data sheet: sums of the lengths of the arm, at q = 0
    "iiwa_link_0": (0, 0, 0),
    "iiwa_link_1": (0, 0, 0.1475),
    "iiwa_link_2": (0, -0.0105, 0.34),
    "iiwa_link_3": (0, 0, 0.5475),
    "iiwa_link_4": (0, 0.0105, 0.74),
    "iiwa_link_5": (0, 0, 0.9475),
    "iiwa_link_6": (0, -0.0707, 1.14),
    "iiwa_link_7": (0, 0, 1.231),
}


@pytest.fixture(scope="module")
def visuals(robot):
    return load_meshes(robot)


def whole(meshes) -> trimesh.Trimesh:
    return trimesh.util.concatenate([mesh for mesh, _color in meshes])


def outstretched(visuals, link: str) -> trimesh.Trimesh:
    return whole(visuals[link]).apply_translation(LINK_ORIGINS_M[link])


@pytest.mark.soak
def test_generating_the_robot_again_gives_the_same_bytes(tmp_path):
    script = ROBOT.parent / "make_iiwa7.py"
    subprocess.run([sys.executable, script, "--output", tmp_path], check=True)
    assert _digests(tmp_path) == _digests(ROBOT / "meshes")


def _digests(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file()
    }


def test_the_arm_has_the_published_width_height_and_reach(visuals):
    links = {link: outstretched(visuals, link) for link in LINK_ORIGINS_M}
    robot = trimesh.util.concatenate(list(links.values()))
    low, high = robot.bounds * MM_PER_M
    assert high[2] == pytest.approx(1266, abs=0.5)  # flange at q = 0
    assert low[2] == pytest.approx(0, abs=0.01)
    for link in ("iiwa_link_1", "iiwa_link_2", "iiwa_link_3", "iiwa_link_4", "iiwa_link_5"):
        assert links[link].extents[0] * MM_PER_M == pytest.approx(136, abs=1)
    base = links["iiwa_link_0"].bounds * MM_PER_M
    assert base[1, 1] - base[0, 1] == pytest.approx(207.5, abs=1)
    assert links["iiwa_link_7"].bounds[1, 2] - 0.035 == pytest.approx(1.231, abs=1e-6)


def test_the_tool_is_a_slender_pointer_that_ends_at_the_tool_tip(visuals):
    tool, tip = whole(visuals["iiwa_link_tool"]), whole(visuals["iiwa_tool_tip_ee"])
    assert tip.bounds[1, 2] == pytest.approx(0, abs=1e-7)
    low = tip.bounds[0, 2]
    assert tool.bounds[1, 2] == pytest.approx(0.2 + low, abs=1e-7)
    shaft = tool.vertices[tool.vertices[:, 2] > 0.1]
    assert np.hypot(shaft[:, 0], shaft[:, 1]).max() <= 0.0031


def test_masses_are_the_published_ones_and_inertias_are_physically_possible():
    model = pinocchio.buildModelFromUrdf(str(ROBOT / "iiwa7.urdf"))
    masses = [3.394011, 4.031991, 3.394011, 4.031989, 1.529239, 2.403626, 0.259474 + 0.25]
    assert [body.mass for body in list(model.inertias)[1:]] == pytest.approx(masses)
    for body in list(model.inertias)[1:]:
        smallest, middle, largest = np.linalg.eigvalsh(body.inertia)
        assert smallest > 0
        assert largest < smallest + middle


@pytest.mark.parametrize(("layout", "frame"), [("", "link"), ("visual", "base")])
def test_a_mesh_folder_may_hold_its_meshes_in_either_frame(tmp_path, visuals, layout, frame):
    folder = tmp_path / layout
    folder.mkdir(exist_ok=True)
    for number, (link, origin) in enumerate(LINK_ORIGINS_M.items()):
        mesh = whole(visuals[link])
        if frame == "base":
            mesh.apply_translation(origin)
        mesh.export(folder / f"link_{number}.stl")
    loaded = load_meshes(load_robot(mesh_folder=tmp_path))
    for link in LINK_ORIGINS_M:
        np.testing.assert_allclose(
            whole(loaded[link]).bounds, whole(visuals[link]).bounds, atol=1e-6
        )
    assert len(loaded["iiwa_link_tool"]) == len(visuals["iiwa_link_tool"]), "the tool stays ours"


def test_a_mesh_in_millimeters_is_refused(tmp_path, visuals):
    mesh = whole(visuals["iiwa_link_3"])
    mesh.vertices *= 1000.0
    mesh.export(tmp_path / "link_3.stl")
    with pytest.raises(InputError, match="in meters"):
        load_meshes(load_robot(mesh_folder=tmp_path))
