"""What leaves the house: without face and names unless somebody wants them kept."""

import json
import re
import zipfile
from dataclasses import replace

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.head.face_removal import face_vertices
from rastrainer.head.mesh import read_head_mesh
from rastrainer.head.surface_queries import nearest_on_mesh
from rastrainer.head.volume import read_head_volume
from rastrainer.scenario.package import unpack
from rastrainer.scenario.scenario import load_scenario
from rastrainer.scenario.writer import write_scenario
from rastrainer_simulator.cli.main import main
from Testing.domain.scenario.made_up_scenario import ball_head, ball_volume, made_up_scenario, png
from Testing.simulator.authoring.heads import egg


def written(folder, spots):
    """Write a scenario whose two tasks have these vertices of an egg as fiducials."""
    head = egg()
    scenario = made_up_scenario()
    points = head.vertices[spots].astype(float).round(4)
    tasks = tuple(replace(task, fiducials=points) for task in scenario.tasks)
    folder.mkdir()
    write_scenario(folder, replace(scenario, tasks=tasks), head, ball_head(60.0), ball_volume(95.0))
    (folder / "preview.png").write_bytes(png())
    return folder


@pytest.fixture
def folder(tmp_path):
    """A scenario whose fiducials are all on the crown."""
    return written(tmp_path / "egg", np.argsort(-egg().vertices[:, 2])[:300:20])


def test_by_default_the_face_is_off_in_mesh_and_picture_and_the_skull_is_out(
    folder, tmp_path, capsys
):
    assert main(["scenario", "pack", str(folder), str(tmp_path / "out.zip")]) == 0
    assert "Taken off: the face, the skull, its title, its name, its source." in (
        capsys.readouterr().out
    )
    given = load_scenario(unpack(tmp_path / "out.zip", tmp_path / "library"))
    head, before = read_head_mesh(given.head_mesh), egg()
    nose = before.vertices[face_vertices(before)][:, 1].max()
    assert head.vertices[:, 1].max() < nose - 3.0
    assert given.skull_mesh is None
    assert "The face was taken off." in given.provenance.method
    images = read_head_volume(given.volume)
    in_front = transforms.apply(transforms.inverse(images.ijk_to_ras), [0.0, 84.0, -36.0])
    i, j, k = np.rint(in_front).astype(int)
    assert read_head_volume(load_scenario(folder).volume).values[i, j, k] == 100
    assert not images.values[i, j:, k].any()
    assert given.preview.read_bytes() != png()
    away = [nearest_on_mesh(head, point).distance for point in given.tasks[0].fiducials]
    assert max(away) < 0.05


def test_face_and_names_are_kept_where_that_is_wanted(folder, tmp_path, capsys):
    words = ["scenario", "pack", str(folder), str(tmp_path / "out.zip"), "--keep-face"]
    assert main([*words, "--keep-names"]) == 0
    assert "Nothing was taken off." in capsys.readouterr().out
    given = load_scenario(unpack(tmp_path / "out.zip", tmp_path / "library"))
    assert given.head_mesh.read_bytes() == (folder / "head.ply").read_bytes()
    assert given.skull_mesh is not None
    assert given.volume.path.read_bytes() == (folder / "volume.nrrd").read_bytes()
    assert given.preview.read_bytes() == png()
    before = load_scenario(folder)
    assert (given.name, given.title) == (before.name, before.title)
    assert given.provenance == before.provenance


def test_by_default_nothing_in_the_file_tells_the_title_or_the_source(tmp_path):
    folder = written(tmp_path / "egg", np.argsort(-egg().vertices[:, 2])[:300:20])
    path = folder / "scenario.json"
    content = json.loads(path.read_text())
    content |= {"title": "Erika Mustermann", "name": "erika-mustermann"}
    content["provenance"]["source"] = "mustermann_erika_t1.nii.gz"
    path.write_text(json.dumps(content))
    words = ["scenario", "pack", str(folder), str(tmp_path / "out.zip"), "--keep-face"]
    assert main(words) == 0
    with zipfile.ZipFile(tmp_path / "out.zip") as archive:
        packed = [name.encode() + archive.read(name) for name in archive.namelist()]
    assert b"mustermann" not in b"".join(packed).lower()
    given = load_scenario(unpack(tmp_path / "out.zip", tmp_path / "library"))
    assert re.fullmatch("head-[0-9a-f]{6}", given.name)
    assert given.provenance.license == content["provenance"]["license"]
    assert given.targets[0].name == "Cyst"


def test_fiducials_on_the_face_are_told_and_nothing_is_written(tmp_path, capsys):
    head = egg()
    spots = np.argsort(-head.vertices[:, 2])[:300:20]
    spots[3] = head.vertices[:, 1].argmax()
    folder = written(tmp_path / "egg", spots)
    assert main(["scenario", "pack", str(folder), str(tmp_path / "out.zip")]) == 2
    assert "has fiducials on the face (4)" in capsys.readouterr().err
    assert not (tmp_path / "out.zip").exists()
