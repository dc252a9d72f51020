"""Exported scenarios: without face and names unless they are to be kept."""

import io
import json
import re
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, nearest_on_mesh, read_head_mesh, write_head_mesh
from rastrainer.head.volume import KEPT_MM, HeadVolume, read_head_volume
from rastrainer.scenario.library import unpack
from rastrainer.scenario.scenario import load_scenario
from rastrainer.scenario.writer import write_scenario
from rastrainer.slicer.head.extraction import findHead
from rastrainer.slicer.head.mask import squaredDistances
from rastrainer.slicer.head.volume import HeadSettings, Volume
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.authoring.export import SIDE, Grid, without_face_in
from rastrainer_simulator.authoring.face_removal import (
    RADIUS_MM,
    check_front,
    face_vertices,
    nose_tip,
    without_face,
)
from rastrainer_simulator.cli.main import main
from Testing.domain.procedure.made_up_procedure import made_up_procedure, shell, trajectory, vessel
from Testing.domain.scenario.made_up_scenario import ball_head, ball_volume, made_up_scenario, png
from Testing.simulator.authoring import heads
from Testing.simulator.authoring.heads import egg
from Testing.simulator.authoring.test_face_removal import head as ball_with_a_face


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


def test_by_default_the_face_is_removed_from_mesh_and_picture_and_the_skull_is_left_out(
    folder, unrendered, tmp_path, capsys
):
    assert main(["scenario", "pack", str(folder), str(tmp_path / "out.zip"), "--yes"]) == 0
    assert "Removed: the face, the skull, its title, its name, its source." in (
        capsys.readouterr().out
    )
    given = load_scenario(unpack(tmp_path / "out.zip", tmp_path / "library"))
    head, before = read_head_mesh(given.head), egg()
    nose = before.vertices[face_vertices(before)][:, 1].max()
    assert head.vertices[:, 1].max() < nose - 3.0
    assert given.skull is None
    assert "The face was taken off." in given.provenance.method
    images = read_head_volume(given.volume)
    in_front = transforms.apply(transforms.inverse(images.ijk_to_ras), [0.0, 84.0, -36.0])
    i, j, k = np.rint(in_front).astype(int)
    assert read_head_volume(load_scenario(folder).volume).values[i, j, k] == 100
    assert not images.values[i, j:, k].any()
    (shown,) = unrendered
    assert np.allclose(shown.vertices, head.vertices, atol=1e-3)
    away = [nearest_on_mesh(head, point).distance for point in given.tasks[0].fiducials]
    assert max(away) < 0.05


def test_face_and_names_are_kept_where_requested(folder, tmp_path, capsys):
    words = ["scenario", "pack", str(folder), str(tmp_path / "out.zip"), "--keep-face"]
    assert main([*words, "--keep-names"]) == 0
    assert "Nothing was removed." in capsys.readouterr().out
    given = load_scenario(unpack(tmp_path / "out.zip", tmp_path / "library"))
    assert given.head.read_bytes() == (folder / "head.ply").read_bytes()
    assert given.skull is not None
    assert given.volume.file.read_bytes() == (folder / "volume.nrrd").read_bytes()
    assert given.preview.read_bytes() == png()
    before = load_scenario(folder)
    assert (given.name, given.title) == (before.name, before.title)
    assert given.provenance == before.provenance


def test_by_default_nothing_in_the_file_reveals_the_title_or_the_source(tmp_path):
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


def test_fiducials_on_the_face_are_reported_and_nothing_is_written(tmp_path, capsys):
    head = egg()
    spots = np.argsort(-head.vertices[:, 2])[:300:20]
    spots[3] = head.vertices[:, 1].argmax()
    folder = written(tmp_path / "egg", spots)
    assert main(["scenario", "pack", str(folder), str(tmp_path / "out.zip"), "--yes"]) == 2
    assert "has fiducials on the face (4)" in capsys.readouterr().err
    assert not (tmp_path / "out.zip").exists()


class Terminal:
    """A user at a terminal."""

    def isatty(self):
        return True


def pixels(path):
    """Return a picture as (height, width, 3) uint8."""
    return np.asarray(Image.open(path).convert("RGB"))


@pytest.mark.usefixtures("unrendered")
@pytest.mark.parametrize(("answer", "status"), [("y", 0), ("", 2)])
def test_a_user_at_a_terminal_sees_before_and_after_and_is_asked(
    folder, tmp_path, capsys, monkeypatch, answer, status
):
    shown = []

    def look(question):
        path = Path(capsys.readouterr().out.splitlines()[0])
        shown.append((question, pixels(path)))
        return answer

    monkeypatch.setattr("sys.stdin", Terminal())
    monkeypatch.setattr("builtins.input", look)
    package = tmp_path / "out.zip"
    assert main(["scenario", "pack", str(folder), str(package)]) == status
    ((question, picture),) = shown
    assert "Is the face gone?" in question
    assert package.exists() == (status == 0)
    before, after = np.split(picture[:, : 3 * SIDE].astype(int), 2)
    front, right, behind = (
        np.abs(before - after)[:, k * SIDE : (k + 1) * SIDE].max(axis=-1) > 40 for k in range(3)
    )
    assert front.mean() > 0.005
    assert right.mean() > 0.01
    assert behind.mean() < 0.001


def test_without_a_terminal_the_picture_must_be_confirmed(folder, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.StringIO("y\n"))
    package, picture = tmp_path / "out.zip", tmp_path / "look.png"
    assert main(["scenario", "pack", str(folder), str(package)]) == 2
    assert "--picture PNG, look at it, and repeat with --yes" in capsys.readouterr().err
    assert main(["scenario", "pack", str(folder), str(package), "--picture", str(picture)]) == 0
    assert pixels(picture).shape[0] == 2 * SIDE
    assert not package.exists()


@pytest.mark.usefixtures("unrendered")
def test_the_face_of_a_head_that_looks_backward_is_not_looked_for_in_its_back(
    folder, tmp_path, capsys
):
    words = ["--picture", str(tmp_path / "look.png")]
    head = egg()
    write_head_mesh(
        folder / "head.ply", HeadMesh(head.vertices * [-1.0, -1.0, 1.0], head.triangles)
    )
    assert main(["scenario", "pack", str(folder), str(tmp_path / "out.zip"), *words]) == 2
    assert "looks backward" in capsys.readouterr().err
    assert not (tmp_path / "out.zip").exists()


def test_a_nose_in_front_raises_no_doubt_and_a_head_without_one_does():
    for head in (heads.small(), egg()):
        assert check_front(head) == ""
        assert "No nose was found in front" in check_front(without_face(head))
        behind = HeadMesh(head.vertices * np.array([-1.0, -1.0, 1.0]), head.triangles)
        with pytest.raises(InputError, match="looks backward"):
            check_front(behind)


REACH_MM = 6
OBLIQUE = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, -1.0]]) * 2.0


@pytest.fixture(scope="module")
def colin27():
    """The default scenario's head, its images, and these without the face."""
    scenario = load_scenario(asset_path("scenarios", "colin27"))
    head, volume = read_head_mesh(scenario.head), read_head_volume(scenario.volume)
    return head, volume, without_face_in(volume, head)


def images_of(head, axes):
    """Return 100 within a head and 0 around it, on a grid with these axes (3, 3), mm."""
    count = np.ceil(260.0 / np.linalg.norm(axes, axis=0)).astype(int)
    matrix = transforms.rigid(axes, -axes @ ((count - 1) / 2.0))
    inside = Grid(tuple(count), matrix).inside(head)
    return HeadVolume(np.where(inside, 100, 0).astype(np.uint8), matrix, 100.0, 50.0)


def distances_to_skin_in(images, places):
    """Return how far places (n, 3), RAS mm, are outside of the head that is found in images.

    It is exact up to `REACH_MM`; farther places are at least so far away.
    """
    volume = Volume(images.values.astype(np.float32), images.ijk_to_ras)
    found = findHead(volume, HeadSettings(), lambda _step, _share: None)
    voxels = tuple(np.rint(places - found.origin).astype(int).T)
    outward, inward = (
        np.sqrt(squaredDistances(body, REACH_MM)[voxels].astype(float))
        for body in (found.body, ~found.body)
    )
    return outward - inward


def middle_of_face(head):
    """Return the vertices (n, 3), RAS mm, of the face that are not near its rim."""
    away = np.linalg.norm(head.vertices - nose_tip(head), axis=1)
    return head.vertices[face_vertices(head) & (away < RADIUS_MM - 12)]


@pytest.mark.soak
def test_skin_extracted_afterward_from_the_images_shows_nothing_of_the_face(colin27):
    head, before, after = colin27
    face = middle_of_face(head)
    assert np.median(np.abs(distances_to_skin_in(before, face))) <= 1.0
    assert distances_to_skin_in(after, face).min() > 4.0


@pytest.mark.soak
def test_the_brain_is_kept_except_close_behind_the_face(colin27):
    head, before, after = colin27
    grid = Grid(before.values.shape, before.ijk_to_ras)
    inside = grid.inside(head)
    is_deep = grid.distances(~inside) > 25.0
    assert is_deep.sum() > 1_000_000
    assert (after.values != before.values)[is_deep].mean() < 0.001
    assert (after.values != before.values)[inside].mean() < 0.06


@pytest.mark.parametrize(
    "axes",
    [
        pytest.param(np.eye(3) * 2.0, id="RAS", marks=pytest.mark.soak),
        pytest.param(OBLIQUE, id="oblique"),
    ],
)
def test_the_images_of_two_people_who_differ_only_in_the_face_are_identical_without_it(axes):
    one, other = ball_with_a_face(brow_mm=4.0), ball_with_a_face(brow_mm=-3.0)
    first, second = images_of(one, axes), images_of(other, axes)
    assert np.count_nonzero(first.values != second.values) > 500
    first, second = without_face_in(first, one), without_face_in(second, other)
    differing = np.count_nonzero(first.values != second.values)
    assert differing < 0.002 * np.count_nonzero(first.values)


def test_nothing_is_left_in_the_images_outside_the_shield_and_in_the_air_around_the_head():
    head = ball_with_a_face()
    images = images_of(head, np.eye(3) * 2.0)
    images.values[2:6, 10:60, 120] = 90
    left = without_face_in(images, head)
    grid = Grid(images.values.shape, images.ijk_to_ras)
    around = np.linalg.norm(grid.places() - nose_tip(head), axis=-1) < RADIUS_MM
    outside = around & ~grid.inside(without_face(head))
    far = grid.distances(grid.inside(head)) > KEPT_MM
    for places in (outside, far):
        assert images.values[places].any()
        assert not left.values[places].any()


def with_procedure(folder):
    """Add a procedure to the scenario of a folder."""
    procedure = made_up_procedure(trajectory(entry=(0, 0, 97), target=(0, 0, 20)))
    procedure = replace(procedure, source="of Erika Mustermann", checkpoints=())
    scenario = replace(load_scenario(folder), procedures=(procedure,))
    planned = folder.parent / "planned"
    planned.mkdir()
    write_scenario(planned, scenario, egg(), shell(), None, {"vessel.ply": vessel()})
    return planned


@pytest.mark.usefixtures("unrendered")
def test_by_default_landmarks_are_left_out_with_the_face_and_procedures_with_the_skull(
    folder, tmp_path, capsys
):
    planned = with_procedure(folder)
    path = planned / "scenario.json"
    nasion = [{"name": "Nasion", "positionRas": [0.0, 90.0, -40.0]}]
    path.write_text(json.dumps(json.loads(path.read_text()) | {"landmarks": nasion}))
    package = tmp_path / "out.zip"
    assert main(["scenario", "pack", str(planned), str(package), "--yes"]) == 0
    assert (
        "Removed: the face, the skull, the landmarks, most of which were on the face, the "
        "procedures, which need the skull, its title"
    ) in capsys.readouterr().out
    given = load_scenario(unpack(package, tmp_path / "library"))
    assert (given.landmarks, given.procedures) == ((), ())
    assert not (given.folder / "no-go").exists()


def test_procedures_are_kept_with_the_face_but_their_sources_are_not(folder, tmp_path):
    package = tmp_path / "out.zip"
    words = ["scenario", "pack", str(with_procedure(folder)), str(package), "--keep-face"]
    assert main(words) == 0
    (procedure,) = load_scenario(unpack(package, tmp_path / "library")).procedures
    assert procedure.trajectories[0].target_ras.tolist() == [0.0, 0.0, 20.0]
    assert procedure.no_go[0].file.is_file()
    assert "Mustermann" not in procedure.source


def test_images_with_nonzero_air_get_air_in_place_of_the_face():
    head = ball_with_a_face()
    images = images_of(head, np.eye(3) * 4.0)
    units = np.where(images.values > 0, 40, -1000).astype(np.int16)
    left = without_face_in(HeadVolume(units, images.ijk_to_ras, 400.0, 40.0), head)
    assert set(np.unique(left.values)) == {-1000, 40}
