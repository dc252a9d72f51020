"""A recorded trial as a film: drawn without a window, encoded by OpenCV."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from pathlib import Path

import numpy as np
from vtkmodules.vtkRenderingCore import vtkActor, vtkRenderer

from rastrainer.errors import InputError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.number_text import clock
from rastrainer.scenario.scenario import Camera, task_by_method
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.rendering.lighting import Shadows, light_room
from rastrainer_simulator.rendering.picture import (
    INSET_SHARE,
    SceneMoment,
    frames,
    lay_in_corner,
    node_actors,
)
from rastrainer_simulator.replay.recorded_trial import RecordedTrial
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.scene.nodes import Material
from rastrainer_simulator.scene.scene_glb import scene_nodes
from rastrainer_simulator.scene.surfaces import vtk_matrix
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.viewpoint.best_view import TouchViews
from rastrainer_simulator.viewpoint.view_control import (
    STILL,
    ViewControl,
    camera_pose,
    orbit_to,
)

RATE_HZ = 25
SIZE = (1280, 720)
CLOSE_UP, FAR = "close-up", "far"


def write_film(
    path: Path,
    trial: RecordedTrial,
    setup: SimulationSetup,
    speed: float = 1.0,
    progress: Callable[[float], None] = lambda _share: None,
) -> None:
    """Write a trial's touches as a film (VP9 in WebM), whole or not at all.

    The picture is the best view of the next fiducial, with the far view in its corner. `speed` is
    in seconds of the trial per second of the film; `progress` gets the finished share.
    """
    if path.suffix.lower() != ".webm":
        raise InputError(f"The film {path.name} must be named *.webm.")
    try:
        import cv2
    except ImportError:
        raise InputError(
            "A film needs OpenCV: install it with `python -m pip install 'rastrainer[film]'`."
        ) from None
    partial = path.with_name(f"{path.stem}.partial.webm")
    encoder = cv2.VideoWriter(str(partial), cv2.VideoWriter.fourcc(*"VP90"), RATE_HZ, SIZE)
    if not encoder.isOpened():
        raise InputError(f"The film {path} cannot be written: is its folder there and writable?")
    count = max(1, round(trial.duration_s / speed * RATE_HZ))
    shown = filmed(trial, setup, (number * speed / RATE_HZ for number in range(count)))
    try:
        for number, pixels in enumerate(shown, start=1):
            encoder.write(pixels[..., ::-1])
            progress(number / count)
        encoder.release()
        partial.replace(path)
    finally:
        shown.close()
        encoder.release()
        partial.unlink(missing_ok=True)


def filmed(
    trial: RecordedTrial, setup: SimulationSetup, times_s: Iterable[float]
) -> Generator[np.ndarray]:
    """Yield pictures of a trial with touches and clock, (height, width, 3) uint8.

    The view moves gently, as if the pictures were `1 / RATE_HZ` s apart.
    """
    import cv2

    scene = _FilmedScene(trial, setup)
    shown = frames(scene.renderer, scene.shots(map(trial.state_at, times_s)))
    try:
        for pixels in shown:
            lay_in_corner(pixels, next(shown))
            state = scene.state
            text = f"{len(state.training.touches)}/{scene.count}   {clock(state.completion_time)}"
            for color, width in (((20, 20, 20), 6), ((255, 255, 255), 2)):
                cv2.putText(
                    pixels, text, (32, 58), cv2.FONT_HERSHEY_DUPLEX, 1.2, color, width, cv2.LINE_AA
                )
            yield pixels
    finally:
        shown.close()


class _FilmedScene:
    """The scene of a trial, whose moving parts follow `state` from frame to frame."""

    def __init__(self, trial: RecordedTrial, setup: SimulationSetup) -> None:
        scenario = setup.scenario
        head = read_head_mesh(scenario.head)
        self.state = first = trial.state_at(0.0)
        task = task_by_method(scenario, trial.task, first.training.method)
        self.count = len(task.labels)
        self._scenario, self._robot, self._head_base = scenario, setup.robot, head.base
        self._kinematics = make_kinematics(setup.robot)
        self._nodes = scene_nodes(scenario, setup.robot, head, task)
        self._views = TouchViews(setup, head)
        self._head_to_world = first.head_to_world.copy()
        self._head_to_world[:3, 3] *= MM_PER_M
        self._views.begin(task, self._head_to_world)
        self._control = ViewControl()
        self._next_point: str | None = None
        self._looks: dict[str, Material] = {}
        self._actors: dict[str, list[vtkActor]] = {}
        self.renderer = vtkRenderer()
        light_room(self.renderer, Shadows.NONE)

    def shots(self, states: Iterable[SimulationState]) -> Iterator[tuple[Camera, tuple[int, int]]]:
        """Show each state in turn; yield its camera and the corner's, each with its size."""
        inset = tuple(round(INSET_SHARE * length) for length in SIZE)
        for state in states:
            self.state, training = state, state.training
            moment = SceneMoment(
                self._kinematics.links(state.q),
                self._head_to_world,
                self._head_base,
                frozenset(touch.label for touch in training.touches),
                training.next_point,
                state.proximity,
            )
            poses, looks = moment.poses(self._robot), moment.looks()
            if looks != self._looks:
                self._looks = looks
                self.renderer.RemoveAllViewProps()
                for node in self._nodes:
                    self._actors[node.name] = node_actors([node], poses, looks)
                    for actor in self._actors[node.name]:
                        self.renderer.AddActor(actor)
            for name, pose in poses.items():
                for actor in self._actors.get(name, ()):
                    actor.SetUserMatrix(vtk_matrix(pose))
            # The camera is on its way to the best view of the next fiducial.
            camera, next_point = self._scenario.cameras[CLOSE_UP], training.next_point
            if next_point is not None and next_point != self._next_point:
                self._next_point = next_point
                best = self._views.best(next_point, state.q)
                if best is not None:
                    self._control.go(orbit_to(camera, best.eye, best.fiducial))
            self._control.advance(1.0 / RATE_HZ, camera, STILL, is_arm_still=True)
            view = camera_pose(camera, self._control.orbit)
            position, focal_point = (
                MM_PER_M * np.array(place) for place in (view.position, view.focal_point)
            )
            yield Camera(position, focal_point, np.array(view.view_up), view.view_angle_deg), SIZE
            yield self._scenario.cameras[FAR], (inset[0], inset[1])
