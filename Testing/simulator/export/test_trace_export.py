"""A trial by a trace is exported for 3D Slicer with its points as a list and as a cloud."""

import numpy as np

from rastrainer import transforms
from rastrainer.files.ply import read_point_cloud
from rastrainer.files.point_files import read_markups
from rastrainer.json_records import record_from_json
from rastrainer.registration.registration import register
from rastrainer.study.database.values import StoredRegistration, StoredTrial
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.export.trial_files import write_slicer_files
from Testing.domain.trial.trial_records import make_traced

LANDMARKS = np.array([[0.0, 90.0, -30.0], [50.0, 60.0, -40.0], [-50.0, 60.0, -40.0]])


def test_points_of_a_trace_are_exported_in_world_and_registered_coordinates(tmp_path):
    record = record_from_json(TrialRecord, make_traced())
    moved = transforms.apply(transforms.rigid(np.eye(3), [100.0, 0.0, 50.0]), LANDMARKS)
    rigid = register(moved, LANDMARKS, labels=record.labels)
    stored = StoredTrial(record, {"rigid": StoredRegistration.of(rigid, None)})
    names = {path.name for path in write_slicer_files(stored, tmp_path)}
    kinds = ("mrk.json", "ply")
    assert {f"traced-{frame}.{kind}" for frame in ("world", "ras") for kind in kinds} < names
    for frame, matrix in (("world", np.eye(4)), ("ras", rigid.matrix)):
        places = transforms.apply(matrix, record.trace_mm)
        listed = read_markups(tmp_path / f"traced-{frame}.mrk.json").points
        np.testing.assert_allclose(listed, places, atol=1e-6)
        cloud = read_point_cloud(tmp_path / f"traced-{frame}.ply")
        np.testing.assert_allclose(cloud, places, atol=1e-3)
    assert read_markups(tmp_path / "touched-world.mrk.json").labels == record.labels
