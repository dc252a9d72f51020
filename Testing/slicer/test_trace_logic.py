"""The trace of the trial in Slicer's scene: its parts, its updates, and its end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer import transforms
from rastrainer.scenario.points import Landmark
from rastrainer.scenario.scenario import Camera
from rastrainer.sections.trace_logic import DISTANCE_SCALARS, TraceLogic
from rastrainer.sections.trial_services import TrialServices
from rastrainer.slicer.scene.nodes import Role
from rastrainer.slicer.scene.scenario_nodes import SceneFileLoader
from rastrainer_headless.scene import HeadlessScene
from Testing.slicer.scene_bundle import load_bundle
from Testing.slicer.simulator_double import run_until_received
from Testing.slicer.training_room import TRIAL, Room

LANDMARKS = {"Nose": (0.0, 90.0, 0.0), "Right": (90.0, 0.0, 0.0), "Top": (0.0, 0.0, 90.0)}
FRONT = Camera(np.array([500.0, -600.0, 350.0]), np.array([500.0, 0.0, 300.0]), np.eye(3)[2], 30.0)


@pytest.fixture
def marked(scenario):
    landmarks = tuple(Landmark(name, np.array(place)) for name, place in LANDMARKS.items())
    return replace(scenario, landmarks=landmarks, cameras={"close-up": FRONT})


class Tracing(Room):
    """A room in which the skin of the ball is traced."""

    def __init__(self, scene, scenario):
        self.to_world, self.places, self.parts = scenario.head_to_world, np.zeros((0, 3)), ()
        super().__init__(scene, scenario)
        services = TrialServices(scene, self.link, None, None, self.work)
        self.traces = TraceLogic(services, lambda: self.now)
        self.parts = SceneFileLoader(scene, self.work), self.traces
        self.logic.sceneShown.connect(self.traces.begin)

    def answer(self, name, arguments):
        if name != "GetTrial":
            return super().answer(name, arguments)
        trace = transforms.apply(self.to_world, self.places)
        touched = transforms.apply(self.to_world, np.array(list(LANDMARKS.values()))).tolist()
        return {
            "task": "task-1",
            "method": "surface",
            "touches": [
                {"label": label, "positionMm": place}
                for label, place in zip(LANDMARKS, touched, strict=True)
            ],
            "trace": [[*place, float(row)] for row, place in enumerate(trace.tolist())],
        }

    def draw(self, count, is_guided=True, on=False, **state):
        """Have the simulator send so many points along the ball's front, a second later."""
        angles = np.radians(np.arange(count, dtype=float))
        self.places = 90.0 * np.stack([np.sin(angles), np.cos(angles), np.zeros(count)], axis=1)
        self.now += 1.0
        values = {"on": on, "kept": count, "strokes": 1, "isGuided": is_guided}
        self.tell(**{"method": "surface", "trace": values, "nextPoint": None, **state})

    def run_until(self, condition):
        def is_met():
            for part in self.parts:
                part.process()
            return condition()

        super().run_until(is_met)

    @property
    def shown(self):
        """The positions of the shown points, RAS; None without any."""
        node = self.node(Role.TRACED_POINTS)
        if node is None or not node.GetPolyData().GetNumberOfPoints():
            return None
        return vtk_to_numpy(node.GetPolyData().GetPoints().GetData())

    @property
    def head(self):
        return self.node(Role.HEAD_MODEL)

    def close(self):
        self.traces.close()
        super().close()


@pytest.fixture
def tracing(scene, marked):
    tracing = Tracing(scene, marked)
    yield tracing
    tracing.close()


def has_points(tracing, count):
    return lambda: tracing.shown is not None and len(tracing.shown) == count


def test_points_lie_where_the_landmarks_place_them_with_the_place_to_draw_next(tracing):
    tracing.draw(40)
    tracing.run_until(has_points(tracing, 40))
    np.testing.assert_allclose(tracing.shown, tracing.places, atol=1e-3)
    display = tracing.head.GetDisplayNode()
    assert display.GetActiveScalarName() == DISTANCE_SCALARS
    assert display.GetScalarRange() == (0.0, 20.0)
    data = tracing.head.GetPolyData()
    vertices = vtk_to_numpy(data.GetPoints().GetData())
    away = vtk_to_numpy(data.GetPointData().GetArray(DISTANCE_SCALARS))
    expected = np.linalg.norm(vertices[:, None] - tracing.places, axis=2).min(axis=1)
    np.testing.assert_allclose(away, np.minimum(expected, 20.0), atol=1e-3)
    place = np.array(tracing.node(Role.NEXT_PLACE).GetNthControlPointPosition(0))
    assert np.linalg.norm(tracing.places - place, axis=1).min() > 10.0
    assert np.linalg.norm(place) == pytest.approx(90.0, abs=0.5)
    # An undone stroke disappears, and without guidance there are only points.
    tracing.draw(10, is_guided=False)
    tracing.run_until(has_points(tracing, 10))
    assert tracing.node(Role.NEXT_PLACE) is None
    assert not tracing.head.GetDisplayNode().GetScalarVisibility()


def test_the_trace_is_requested_once_a_second_and_only_as_it_grows(tracing):
    tracing.draw(5)
    tracing.run_until(has_points(tracing, 5))
    tracing.now -= 0.5
    tracing.draw(9)
    states = []
    tracing.link.stateChanged.connect(states.append)
    tracing.tell(method="surface", nextPoint=None, trace={"kept": 9, "strokes": 1})
    tracing.run_until(lambda: states)
    assert len(tracing.sent("GetTrial")) == 1
    tracing.now += 0.5
    tracing.run_until(has_points(tracing, 9))
    assert tracing.sent("GetTrial") == 2 * [{"trialId": TRIAL}]


def test_the_trace_is_saved_with_the_scene_and_disappears_when_the_trial_ends(
    tracing, headless_scene, tmp_path
):
    tracing.draw(40)
    tracing.run_until(lambda: tracing.node(Role.NEXT_PLACE) is not None)
    headless_scene.save(tmp_path / "trace.mrb")
    again = HeadlessScene()
    load_bundle(again, tmp_path / "trace.mrb")
    saved = Role.TRACED_POINTS.find(again.scene).GetPolyData()
    assert saved.GetNumberOfPoints() == 40
    assert Role.NEXT_PLACE.find(again.scene).GetNumberOfControlPoints() == 1
    tracing.tell(phase="registered", method="surface", trace={"kept": 40, "strokes": 1})
    tracing.run_until(lambda: tracing.shown is None)
    assert tracing.node(Role.TRACED_POINTS) is None
    assert tracing.node(Role.NEXT_PLACE) is None
    assert not tracing.head.GetDisplayNode().GetScalarVisibility()
    assert tracing.head.GetDisplayNode().GetOpacity() == 1.0
    assert tracing.head.GetPolyData().GetPointData().GetArray(DISTANCE_SCALARS) is None


def test_invalid_data_from_the_simulator_shows_nothing_and_breaks_nothing(tracing):
    tracing.draw(40, trace={"kept": "many", "strokes": None, "on": 3})
    tracing.places = np.full((600, 3), np.nan)
    tracing.run_until(lambda: tracing.sent("GetTrial"))
    run_until_received(tracing.link)
    # The answer to an earlier command has arrived, too.
    tracing.run_until(lambda: not tracing.work.isBusy)
    assert tracing.shown is None
    tracing.draw(12)
    tracing.run_until(has_points(tracing, 12))
