"""The errors of procedures, computed again from their exported files by VTK and Slicer."""

import json
import math
import os
from dataclasses import replace
from operator import attrgetter

import numpy as np
import pytest
import slicer
import vtk
from slicer.util import arrayFromVTKMatrix, vtkMatrixFromArray
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

from rastrainer import transforms
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.procedure.errors import analyze_procedure
from rastrainer.procedure.record import ProcedureRecord, RecordedAttempt, UsedRegistration
from rastrainer.registration.registration import register
from rastrainer.study.database.values import StoredTrial
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.export.trial_files import write_slicer_files
from Testing.domain.procedure.made_up_procedure import (
    VESSEL_CENTER,
    made_up_meshes,
    made_up_procedure,
    trajectory,
)
from Testing.domain.procedure.procedure_records import placed, recorded, rotation
from Testing.domain.trial.trial_records import make_record

EQUAL = 1e-6
"""mm and degrees."""
FLE_MM = 1.5


@pytest.fixture(scope="module")
def meshes():
    return made_up_meshes()


@pytest.fixture(scope="module")
def skull(meshes):
    """The skull as VTK's locator of its crossings with lines."""
    locator = vtk.vtkOBBTree()
    locator.SetDataSet(poly_data(meshes.skull))
    locator.SetTolerance(0.0)
    locator.BuildLocator()
    return locator


def poly_data(mesh):
    points, triangles, surface = vtk_points(), vtk.vtkCellArray(), vtk.vtkPolyData()
    points.SetData(numpy_to_vtk(mesh.vertices, deep=True))
    corners = mesh.triangles.astype(np.int64).ravel()
    triangles.SetData(3, numpy_to_vtkIdTypeArray(corners, deep=True))
    surface.SetPoints(points)
    surface.SetPolys(triangles)
    return surface


class SlicerLine:
    """A line as Slicer has read it from a file."""

    def __init__(self, scene, path):
        self.node = scene.AddNewNodeByClass("vtkMRMLMarkupsLineNode")
        storage = slicer.vtkMRMLMarkupsJsonStorageNode()
        storage.SetFileName(str(path))
        assert storage.ReadData(self.node)
        assert self.node.GetNumberOfControlPoints() == 2
        self.start, self.end = (self.node.GetNthControlPointPositionWorld(row) for row in range(2))

    @property
    def direction(self):
        return np.subtract(self.end, self.start)


def off_line(point, line):
    """The distance of a point from the infinite line, by VTK."""
    return math.sqrt(vtk.vtkLine.DistanceToLine(point, line.start, line.end))


def angle(a, b):
    return vtk.vtkMath.DegreesFromRadians(vtk.vtkMath.AngleBetweenVectors(a, b))


def along(start, end, line):
    direction = line.direction
    vtk.vtkMath.Normalize(direction)
    return vtk.vtkMath.Dot(np.subtract(end, start), direction)


def vtk_points(positions=()):
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    for position in positions:
        points.InsertNextPoint(position)
    return points


def landmark_matrix(moving, fixed):
    """The rigid registration by which Slicer registers landmarks."""
    both = [vtk_points(positions) for positions in (moving, fixed)]
    transform = vtk.vtkLandmarkTransform()
    transform.SetSourceLandmarks(both[0])
    transform.SetTargetLandmarks(both[1])
    transform.SetModeToRigidBody()
    transform.Update()
    return transform.GetMatrix()


def carried_out(seed):
    """A trial with a procedure, its fiducials and the true pose: all of it random."""
    random = np.random.default_rng([21, seed])
    head_to_world = transforms.rigid(rotation(random, 180.0), random.normal(0.0, 300.0, 3))
    fiducials = random.normal(0.0, 55.0, (15, 3))
    touches = transforms.apply(head_to_world, fiducials)
    touches += random.normal(0.0, FLE_MM / np.sqrt(3), touches.shape)
    used = register(touches, fiducials)
    procedure = made_up_procedure(
        *(
            trajectory(f"Line {number}", entry, target)
            for number, (entry, target) in enumerate(ends(random), start=1)
        )
    )
    to_world = transforms.inverse(used.matrix)
    instruments = tuple(_by_hand(random, each, to_world) for each in procedure.trajectories)
    registration = UsedRegistration(tuple(used.matrix.ravel().tolist()), used.fre_mm, 0.6)
    attempts = (RecordedAttempt((), registration, ()),)
    name, kind, times = procedure.name, procedure.kind, {"running": 100.0}
    done = ProcedureRecord(name, kind, "0" * 64, 300.0, attempts, instruments, times)
    record = make_record(procedure=record_to_json(done))
    for point, position in zip(record["points"], touches, strict=True):
        point["positionMm"] = position.tolist()
    trial = record_from_json(TrialRecord, json.loads(json.dumps(record)))
    truth = RevealedTruth(tuple(head_to_world.ravel().tolist()), 0.5)
    stored = StoredTrial(trial, {}, truth=truth)
    return procedure, fiducials, stored


def ends(random):
    for _ in range(random.integers(1, 4)):
        out = random.normal(size=3)
        out[2] = abs(out[2])
        yield 90.0 * out / np.linalg.norm(out), random.normal(0.0, 15.0, 3)


def _by_hand(random, planned, to_world):
    exact = placed(planned, to_world, drill=random.uniform(0.0, 30.0))
    turned = rotation(random, 3.0) @ np.array(exact.guide_direction)
    return replace(
        exact,
        guide_tip_mm=tuple((np.array(exact.guide_tip_mm) + random.normal(0.0, 1.0, 3)).tolist()),
        guide_direction=tuple((turned / np.linalg.norm(turned)).tolist()),
        instrument_depth_mm=exact.instrument_depth_mm + random.normal(0.0, 2.0),
    )


@pytest.mark.parametrize("procedures", [15, pytest.param(1000, marks=pytest.mark.soak)])
def test_vtk_and_slicer_compute_the_same_errors_from_the_exported_files(
    meshes, skull, tmp_path, monkeypatch, procedures
):
    monkeypatch.setattr(os, "fsync", lambda _file: None)
    scene, count = slicer.vtkMRMLScene(), 0
    for seed in range(procedures):
        procedure, fiducials, stored = carried_out(seed)
        write_slicer_files(stored, tmp_path)
        exported = json.loads(json.dumps(record_to_json(stored.record)))
        truth = np.reshape(stored.truth.head_to_world, (4, 4))
        ours = analyze_procedure(stored.record.procedure, procedure, meshes, truth)
        targets = []
        done = zip(ours.trajectories, stored.record.procedure.instruments, strict=True)
        for number, (errors, instrument) in enumerate(done, start=1):
            lines = {
                kind: SlicerLine(scene, tmp_path / f"trajectory-{number}-{kind}.mrk.json")
                for kind in ("planned", "shown", "placed")
            }
            compare(errors, **lines)
            compare_registration(exported, fiducials, truth, lines)
            compare_drill(errors, instrument, lines["placed"], skull)
            targets.append(math.dist(lines["placed"].end, lines["planned"].end))
            count += 1
        rms = math.sqrt(sum(target**2 for target in targets) / len(targets))
        assert ours.target_point_error_rms_mm == pytest.approx(rms, abs=EQUAL)
        scene.Clear(0)
    assert count > 1.5 * procedures


def compare(errors, planned, shown, placed):
    tip, directions = placed.end, (planned.direction, shown.direction, placed.direction)
    for name, expected in {
        "entry_point_error.mm": off_line(planned.start, placed),
        "entry_point_error.by_hand_mm": off_line(shown.start, placed),
        "target_point_error.mm": math.dist(tip, planned.end),
        "target_point_error.by_registration_mm": math.dist(shown.end, planned.end),
        "target_point_error.by_hand_mm": math.dist(tip, shown.end),
        "radial_error.mm": off_line(tip, planned),
        "depth_error_mm": along(planned.end, tip, planned),
        "depth_error_by_registration_mm": along(planned.end, shown.end, planned),
        "depth_error_by_hand_mm": along(shown.end, tip, planned),
        "angular_deviation_deg": angle(directions[0], directions[2]),
        "angular_deviation_by_registration_deg": angle(*directions[:2]),
        "angular_deviation_by_hand_deg": angle(*directions[1:]),
    }.items():
        assert attrgetter(name)(errors) == pytest.approx(expected, abs=EQUAL), name


def compare_registration(exported, fiducials, truth, lines):
    """Register the exported touches again, and see where the plan was shown by that."""
    touches = [point["positionMm"] for point in exported["points"]]
    matrix = landmark_matrix(touches, fiducials)
    used = exported["procedure"]["attempts"][-1]["registration"]["matrix"]
    assert arrayFromVTKMatrix(matrix).ravel() == pytest.approx(used, abs=EQUAL)
    to_world, to_ras = vtk.vtkMatrix4x4(), vtk.vtkMatrix4x4()
    vtk.vtkMatrix4x4.Invert(matrix, to_world)
    vtk.vtkMatrix4x4.Invert(vtkMatrixFromArray(truth), to_ras)
    for planned, shown in (
        (lines["planned"].start, lines["shown"].start),
        (lines["planned"].end, lines["shown"].end),
    ):
        there = to_ras.MultiplyPoint(to_world.MultiplyPoint([*planned, 1.0]))
        assert there[:3] == pytest.approx(shown, abs=EQUAL)


def compare_drill(errors, instrument, placed, skull):
    """Find both tables along the instrument by VTK."""
    far = placed.start + 3.0 * placed.direction
    points = vtk_points()
    skull.IntersectWithLine(placed.start, far, points, None)
    crossings = sorted(
        math.dist(placed.start, points.GetPoint(row)) for row in range(points.GetNumberOfPoints())
    )
    outer, inner = crossings[:2]
    assert errors.outer_table_mm == pytest.approx(outer, abs=EQUAL)
    assert errors.inner_table_mm == pytest.approx(inner, abs=EQUAL)
    plunge = max(0.0, instrument.drill_depth_mm - inner)
    assert errors.plunge_mm == pytest.approx(plunge, abs=EQUAL)


@pytest.mark.parametrize("seed", range(3))
def test_the_distance_kept_to_a_structure_is_that_of_vtk(meshes, seed):
    """The least of VTK's distances along an instrument that passes or hits the structure."""
    to_vessel = vtk.vtkImplicitPolyDataDistance()
    to_vessel.SetInput(poly_data(meshes.no_go["Vessel"]))
    random = np.random.default_rng([22, seed])
    target = VESSEL_CENTER + random.normal(0.0, 6.0, 3)
    procedure = made_up_procedure(trajectory("Line", (0.0, 0.0, 90.0), target))
    ours = analyze_procedure(recorded(procedure, np.eye(4)), procedure, meshes, np.eye(4))
    (errors,) = ours.trajectories
    begin, end = np.array(errors.guide_tip_ras), np.array(errors.tip_ras)
    shares = np.linspace(0.0, 1.0, 200)
    for _ in range(2):
        places = [begin + share * (end - begin) for share in shares]
        best = int(np.argmin([to_vessel.EvaluateFunction(place) for place in places]))
        around = shares[max(0, best - 1)], shares[min(len(shares) - 1, best + 1)]
        least, shares = to_vessel.EvaluateFunction(places[best]), np.linspace(*around, 200)
    radius = procedure.trajectories[0].diameter_mm / 2
    assert errors.kept_mm["Vessel"] + radius == pytest.approx(max(0.0, least), abs=1e-3)
    assert ours.hits == ((("Line", "Vessel"),) if least <= radius else ())
