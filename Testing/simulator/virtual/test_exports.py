"""Exports of a study are as other programs expect them, and reveal no names."""

import json
import re
import subprocess
import sys
import uuid
from pathlib import Path

import numpy as np
import pytest
import vtk

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.journal.folder import journals_of
from rastrainer.journal.recording import read_trajectory
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.study.database.study import Study
from rastrainer.study.study_data import read_study_data
from rastrainer_headless.scene import HeadlessScene
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.export.trial_files import participant_labels, write_motion_bids
from rastrainer_simulator.virtual.cohort import DATABASE, RECORDS

VALIDATOR = Path(sys.executable).with_name("bids-validator-deno")


@pytest.fixture(scope="module")
def exported(played, tmp_path_factory):
    folder = tmp_path_factory.mktemp("export") / "all"
    words = ["export", played / DATABASE, "-o", folder, "--records", played / RECORDS]
    assert main([str(word) for word in words]) == 0
    return folder


def test_the_bids_validator_finds_no_error(exported):
    ended = subprocess.run(
        [VALIDATOR, "--format", "json", exported / "bids"], capture_output=True, check=False
    )
    issues = json.loads(ended.stdout)["issues"]["issues"]
    assert [issue for issue in issues if issue["severity"] == "error"] == []
    assert ended.returncode == 0
    assert len(list(exported.glob("bids/sub-*/motion/*_motion.tsv"))) == 4


def test_the_bids_samples_match_those_of_the_journal(played, exported, capsys):
    (path,) = exported.glob("bids/sub-V0001/motion/*acq-hmd*_motion.tsv")
    values = np.loadtxt(path, delimiter="\t")
    trial = next(
        t for t in read_study_data(played / DATABASE).of_mode("hmd") if t.trainee == "V0001"
    )
    trajectory = read_trajectory(played / RECORDS, trial.trial_id)
    at = np.arange(len(values)) / 50.0 + trajectory.times_s[0]
    for column in range(3):
        expected = np.interp(at, trajectory.times_s, trajectory.tip_mm[:, column])
        np.testing.assert_allclose(values[:, column], expected, atol=1e-4)
    (journal,) = journals_of(played / RECORDS, trial.trial_id)
    assert main(["measure", str(journal), "--json"]) == 0
    measured = json.loads(capsys.readouterr().out)
    assert measured == trial_motion(trajectory)
    assert measured.items() <= trial.values.items()
    assert main(["measure", str(journal), "--explain"]) == 0
    assert "Balasubramanian" in capsys.readouterr().out


def test_xapi_statements_have_what_the_specification_requires(exported):
    statements = json.loads((exported / "xapi" / "statements.json").read_text())
    assert len(statements) == len({statement["id"] for statement in statements}) == 4
    for statement in statements:
        uuid.UUID(statement["id"])
        assert set(statement) <= {
            *("id", "version", "actor", "verb", "object", "result", "context", "timestamp")
        }
        assert set(statement["actor"]["account"]) == {"homePage", "name"}
        for iri in (statement["verb"]["id"], statement["object"]["id"]):
            assert iri.startswith(("http://", "https://"))
        score = statement["result"]["score"]
        # A provider that sets the version must set this version for every patch.
        assert statement["version"] == "1.0.0"
        assert statement["result"]["completion"] is True
        assert isinstance(statement["result"]["success"], bool)
        assert -1 <= score["scaled"] <= 1
        assert score["min"] <= score["raw"] <= score["max"]
        assert re.fullmatch(r"PT\d+\.\d\dS", statement["result"]["duration"])
        extensions = {**statement["result"]["extensions"], **statement["context"]["extensions"]}
        assert all(key.startswith("https://") for key in extensions)
        assert statement["timestamp"].endswith("Z")


def test_slicer_reads_the_touches_the_transform_and_the_residuals(played, exported):
    with Study.open(played / DATABASE) as study:
        trial = study.history("V0001")[0]
    folder = exported / "slicer" / trial.record.trial_id
    scene, rigid = HeadlessScene().scene, trial.registrations["rigid"]
    node = read_by_slicer(scene, "LinearTransform", "Transform", folder / "WorldToRas.tfm")
    matrix = vtk.vtkMatrix4x4()
    node.GetMatrixTransformToParent(matrix)
    found = np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])
    np.testing.assert_allclose(found, np.reshape(rigid.matrix, (4, 4)))
    world, ras = (
        read_by_slicer(
            scene, "MarkupsFiducial", "MarkupsJson", folder / f"touched-{frame}.mrk.json"
        )
        for frame in ("world", "ras")
    )
    assert [world.GetNthControlPointLabel(i) for i in range(15)] == list(trial.record.labels)
    np.testing.assert_allclose(points_of(world), trial.record.positions_mm, atol=1e-6)
    moved = transforms.apply(found, points_of(world))
    np.testing.assert_allclose(moved, points_of(ras), atol=1e-6)
    table = read_by_slicer(scene, "Table", "Table", folder / "residuals.csv").GetTable()
    labels, residuals = table.GetColumnByName("fiducial"), table.GetColumnByName("residual_mm")
    read = [(labels.GetValue(i), float(residuals.GetValue(i))) for i in range(15)]
    assert read == list(zip(rigid.labels, rigid.residuals_mm, strict=True))


def read_by_slicer(scene, kind, storage_kind, path):
    """The node of a kind that Slicer's own storage node of another kind reads from a file."""
    node = scene.AddNewNodeByClass(f"vtkMRML{kind}Node")
    storage = scene.AddNewNodeByClass(f"vtkMRML{storage_kind}StorageNode")
    storage.SetFileName(str(path))
    assert storage.ReadData(node) == 1
    return node


def points_of(markups):
    count = markups.GetNumberOfControlPoints()
    return np.array([markups.GetNthControlPointPosition(i) for i in range(count)])


def test_exporting_motion_bids_without_journals_is_refused(played, tmp_path, capsys):
    words = ["export", played / DATABASE, "-o", tmp_path / "x", "--format", "bids"]
    assert main([str(word) for word in words]) == 2
    assert "give their folder with --records" in capsys.readouterr().err
    with pytest.raises(InputError, match="No trial of the study has a journal"):
        write_motion_bids(read_study_data(played / DATABASE), tmp_path / "y", lambda _id: None)


def test_participant_labels_are_plain_and_distinct():
    labels = participant_labels(("T-1", "T1", "../..", "Ä", "t1"))
    assert len({label.lower() for label in labels.values()}) == 5
    assert all(label.isascii() and label.isalnum() for label in labels.values())
