"""`rastrainer scenario build` refuses broken volumes, and reads unusual volumes correctly."""

from __future__ import annotations

import tempfile

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.files.point_files import write_markups
from rastrainer.files.point_list import PointList
from rastrainer.head.mesh import read_head_mesh
from rastrainer.head.volume import check_place, read_head_volume
from rastrainer.scenario.points import LABELS
from rastrainer.scenario.scenario import load_scenario
from rastrainer_headless.make_head import main as make_head
from rastrainer_simulator.cli.main import main
from Testing.slicer.head.broken_volumes import HEADLESS
from Testing.slicer.head.dicom_series import LPS_TO_RAS, slices, write_slices
from Testing.slicer.head.phantoms import CT, NOSE, SAGITTAL, depth_mm, phantom
from Testing.slicer.head.placed import fiducials
from Testing.slicer.head.volume_file import write_volume

SIZE = 0.75
"""Size of the heads; small heads are found faster."""
NOTHING_SCANNED_BELOW = 5.0
"""Height (S) above which no phantom here lacks a part of its head, mm."""


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    """The user's home and the folder of temporary files, for the processes too."""
    for name in ("home", "temporary"):
        (tmp_path / name).mkdir()
    for name in ("HOME", "USERPROFILE"):
        monkeypatch.setenv(name, str(tmp_path / "home"))
    monkeypatch.setenv("TMPDIR", str(tmp_path / "temporary"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    return tmp_path


def sagittal(folder):
    """Write a NIfTI file that is stored slice by slice from the left."""
    scan = phantom(spacing=(2.0, 2.0, 2.0), axes=SAGITTAL, size=SIZE)
    return write_volume(folder / "head.nii.gz", scan)


def dicom(folder):
    scan = phantom(CT, spacing=(2.0, 2.0, 2.5), size=SIZE)
    write_slices(
        folder / "series", slices(scan.values.astype(np.int16), LPS_TO_RAS @ scan.ijkToRas)
    )
    return folder / "series"


def block(folder):
    return write_volume(folder / "head.nrrd", HEADLESS["a block"][0])


def cut_nifti(folder):
    """Write a head's file without its end."""
    scan = phantom(spacing=(3.0, 3.0, 3.0), noise=1.0)
    path = write_volume(folder / "head.nii.gz", scan)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    return path


def cut_dicom(folder):
    path = sorted(dicom(folder).iterdir())[7]
    path.write_bytes(path.read_bytes()[:-100])
    return path.parent


@pytest.mark.parametrize(
    ("write", "sentence"),
    [(block, HEADLESS["a block"][1]), (cut_nifti, "is cut short"), (cut_dicom, "is cut short")],
    ids=["a block", "NIfTI", "DICOM"],
)
def test_the_process_that_finds_the_head_refuses_a_broken_volume(place, capfd, write, sentence):
    volume = write(place)
    before = everything_in(place)
    assert make_head([str(volume), "-o", str(place / "made")]) == 2
    assert sentence in capfd.readouterr().err.splitlines()[-1]
    assert everything_in(place) == before


def test_a_broken_volume_is_reported_in_one_sentence_and_changes_nothing(place, capfd):
    volume, sentence = block(place), HEADLESS["a block"][1]
    before = everything_in(place)
    assert main(["scenario", "build", str(volume), "-o", str(place / "made")]) == 2
    said = capfd.readouterr().err.splitlines()
    assert len(said) == 1
    assert sentence in said[0]
    assert everything_in(place) == before


@pytest.mark.parametrize(
    ("write", "options"),
    [
        pytest.param(dicom, [], id="DICOM"),
        pytest.param(sagittal, ["--cut=-30"], id="NIfTI", marks=pytest.mark.soak),
    ],
)
def test_an_unusual_volume_becomes_a_scenario_with_the_right_skin(place, capfd, write, options):
    write_markups(place / "mine.mrk.json", PointList(LABELS, fiducials(SIZE)))
    words = ["scenario", "build", str(write(place)), "-o", str(place / "made"), "--no-skull"]
    status = main([*words, *options, "--tasks", str(place / "mine.mrk.json")])
    assert status == 0, capfd.readouterr().err
    scenario = load_scenario(place / "made")
    assert [task.title for task in scenario.tasks] == ["Trial run"]
    mesh = read_head_mesh(scenario.head)
    assert mesh.is_closed
    assert mesh.euler_characteristic == 2
    scanned = mesh.vertices[mesh.vertices[:, 2] > NOTHING_SCANNED_BELOW]
    away = scanned[np.linalg.norm(scanned - SIZE * NOSE, axis=1) > 20.0]
    assert np.abs(depth_mm(away, SIZE)).mean() < 0.6
    images = read_head_volume(scenario.volume)
    check_place(images, mesh, scenario.volume.file)
    brain = transforms.apply(transforms.inverse(images.ijk_to_ras), [0.0, 10.0, 30.0])
    shown = images.values[tuple(np.rint(brain).astype(int))] - images.level
    assert abs(shown) < 0.5 * images.window


def everything_in(folder):
    """Return the content of every file below a folder by path; None for a folder."""
    return {
        path: path.read_bytes() if path.is_file() else None for path in sorted(folder.rglob("*"))
    }
