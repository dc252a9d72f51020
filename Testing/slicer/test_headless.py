"""The headless side plays Slicer's part to the end: lines, files, exit status."""

import json
import threading
import time
import uuid
from pathlib import Path

import numpy as np
import pytest
import vtk
from slicer.util import arrayFromTransformMatrix
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer import transforms
from rastrainer.igtl.content import Point, Points
from rastrainer.protocol import DeviceName
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.scene.nodes import Role, labelsOf, worldPoints
from rastrainer.slicer.scene.trial_scene import FIXED_REFERENCE, isApplied
from rastrainer.study.database.study import Study
from rastrainer_headless import main as headless
from rastrainer_headless import residual_picture
from rastrainer_headless.scene import HeadlessScene
from Testing.slicer.scene_bundle import load_bundle
from Testing.slicer.simulator_double import SimulatorDouble

ASSETS = Path(__file__).parents[2] / "assets"
COLIN = ASSETS / "scenarios" / "colin27"
TRIAL = str(uuid.UUID(int=5))
SEED = 1


class PlayingDouble(SimulatorDouble):
    """Plays one trial after the greeting: fifteen touches, then the record."""

    def __init__(self, record):
        super().__init__(self.respond)
        self.record = record
        self.scenario = load_scenario(COLIN)
        self.has_played = False

    def respond(self, name, arguments):
        # On a busy machine the link may go stale and greet again.
        if name == "Hello" and not self.has_played:
            self.has_played = True
            threading.Thread(target=self.play, daemon=True).start()
        if name != "SubmitRegistration":
            return {}
        head_to_world = self.scenario.perturbed_head_to_world(SEED)
        found = np.reshape(arguments["matrix"], (4, 4)) @ head_to_world
        target = self.scenario.target.position_ras
        return {
            "headToWorld": head_to_world.ravel().tolist(),
            "trueTreMm": float(np.linalg.norm(transforms.apply(found, target) - target)),
        }

    def play(self):
        touched = [Point(point["label"], point["positionMm"]) for point in self.record["points"]]
        for count in range(1, 16):
            self.send(DeviceName.CAPTURED_POINTS, Points(tuple(touched[:count])))
            time.sleep(0.03)
        self.send_command("TrialCompleted", self.record)


@pytest.fixture
def colin_record(make_record):
    scenario = load_scenario(COLIN)
    random = np.random.default_rng(SEED)
    fiducials = scenario.task("task-1").fiducials + random.normal(0.0, 0.7, (15, 3))
    touched = transforms.apply(scenario.perturbed_head_to_world(SEED), fiducials)
    record = make_record(TRIAL, scenario="colin27")
    for point, position in zip(record["points"], touched, strict=True):
        point["positionMm"] = position.tolist()
    return record


def arguments(output, port, *more):
    return ["--port", str(port), "--output", str(output), "--assets", str(ASSETS), *more]


def lines_of(text, event):
    lines = [json.loads(line) for line in text.splitlines()]
    return [line for line in lines if line["event"] == event]


def test_a_trial_is_played_and_its_files_are_written(colin_record, tmp_path, capfd):
    with PlayingDouble(colin_record) as simulator:
        words = arguments(tmp_path, simulator.port, "--timeout", "300")
        assert headless.main(words) == 0
    text = capfd.readouterr().out
    (trial,) = lines_of(text, "trial")
    (line,) = (tmp_path / "results.jsonl").read_text().splitlines()
    written = json.loads(line)
    assert trial["results"] == written
    assert written["truth"]["trueTreMm"] < 2.0
    (output,) = lines_of(text, "output")
    assert all(Path(output[name]).stat().st_size > 1000 for name in ("scene", "picture", "study"))
    with Study.open(tmp_path / "study.db") as study:
        assert study.trial(TRIAL).true_tre_mm == written["truth"]["trueTreMm"]
    check_saved_scene(tmp_path / "trial.mrb", written)
    check_picture(Path(output["picture"]))


def check_saved_scene(path, results):
    application = HeadlessScene()
    load_bundle(application, path)
    scene = application.scene
    transform = Role.WORLD_TO_HEAD.find(scene)
    matrix = np.reshape(results["fits"]["rigid"]["matrix"], (4, 4))
    np.testing.assert_allclose(arrayFromTransformMatrix(transform), matrix, atol=1e-9)
    assert isApplied(transform)
    touched = scene.GetFirstNode("CapturedPoints", "vtkMRMLMarkupsFiducialNode")
    fixed = transform.GetNodeReference(FIXED_REFERENCE)
    assert labelsOf(touched) == labelsOf(fixed)
    residuals = np.linalg.norm(worldPoints(touched) - worldPoints(fixed), axis=1)
    np.testing.assert_allclose(residuals, results["fits"]["rigid"]["residualsMm"], atol=2e-3)
    assert Role.HEAD_MODEL.find(scene).GetPolyData().GetNumberOfPolys() > 40_000
    images = Role.HEAD_VOLUME.find(scene)
    assert images.GetImageData().GetDimensions() == (204, 228, 178)
    red = scene.GetNodeByID("vtkMRMLSliceCompositeNodeRed")
    assert red.GetBackgroundVolumeID() == images.GetID()
    assert Role.FITS.find(scene).GetNumberOfRows() == 3
    assert Role.RESIDUAL_ARROWS.find(scene).GetPolyData() is not None
    assert scene.GetFirstNodeByName("ToolTipToWorld") is None


def check_picture(path):
    """Look for the head, its points and the legend."""
    reader = vtk.vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    assert image.GetDimensions()[:2] == (residual_picture.WIDTH, residual_picture.HEIGHT)
    scalars = vtk_to_numpy(image.GetPointData().GetScalars())
    pixels = scalars.reshape(residual_picture.HEIGHT, residual_picture.WIDTH, -1)[..., :3]
    saturation, edge = np.ptp(pixels.astype(int), axis=2), int(0.9 * residual_picture.WIDTH)
    assert (pixels[:, :edge].max(axis=2) < 250).mean() > 0.3
    assert (saturation[:, :edge] > 60).sum() > 15 * 100
    assert (saturation[:, edge:] > 60).sum() > 5000


def test_trials_that_do_not_arrive_exit_with_status_1_and_a_message(simulator, tmp_path, capfd):
    assert headless.main(arguments(tmp_path, simulator.port, "--timeout", "0.3")) == 1
    error = capfd.readouterr().err.strip()
    assert error.startswith("rastrainer: 0 of 1 trials came within 0.3 s.")
    assert "\n" not in error


def test_bad_arguments_exit_with_status_2_and_an_unusable_folder_is_left_alone(tmp_path, capfd):
    for *changes, words in (
        ("--assets", "nowhere", "There is no file nowhere"),
        ("--trials", "0", "at least one trial"),
        ("--timeout", "nan", "seconds above 0"),
    ):
        assert headless.main(arguments(tmp_path, 18944, *changes)) == 2
        assert words in capfd.readouterr().err
    (tmp_path / "study.db").write_text("my notes")
    assert headless.main(arguments(tmp_path / "study.db" / "folder", 18944)) == 2
    assert "cannot be made" in capfd.readouterr().err
    assert headless.main(arguments(tmp_path, 18944)) == 2
    assert "study" in capfd.readouterr().err
    assert (tmp_path / "study.db").read_text() == "my notes"
