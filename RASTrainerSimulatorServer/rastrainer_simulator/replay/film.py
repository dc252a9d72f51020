"""A recorded trial as a film: drawn without a window, encoded by OpenCV."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from itertools import chain
from pathlib import Path

import numpy as np
from vtkmodules.vtkRenderingCore import vtkActor, vtkRenderer

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.number_text import clock
from rastrainer.scenario.points import Task
from rastrainer.scenario.scenario import Camera, task_by_method
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.net.views.outgoing import BODIES
from rastrainer_simulator.rendering.lighting import Shadows, light_room
from rastrainer_simulator.rendering.picture import (
    INSET_SHARE,
    frames,
    lay_in_corner,
    looks_of,
    node_actors,
)
from rastrainer_simulator.replay.recorded_trial import RecordedTrial
from rastrainer_simulator.scene.nodes import Material
from rastrainer_simulator.scene.scene_glb import scene_nodes
from rastrainer_simulator.scene.surfaces import vtk_matrix
from rastrainer_simulator.viewpoint.best_view import TouchViews
from rastrainer_simulator.viewpoint.view_control import STILL, ViewControl, camera_pose, orbit_to

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
    shown = filmed(trial, setup, [number * speed / RATE_HZ for number in range(count)])
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
    trial: RecordedTrial, setup: SimulationSetup, times_s: Sequence[float]
) -> Generator[np.ndarray]:
    """Yield pictures of a trial with touches and clock, (height, width, 3) uint8.

    The view moves gently, as if the pictures were `1 / RATE_HZ` s apart.
    """
    import cv2

    method = trial.state_at(0.0).training.method
    task = task_by_method(setup.scenario, trial.task, method)
    renderer = vtkRenderer()
    light_room(renderer, Shadows.NONE)
    shown = frames(renderer, _shots(renderer, setup, task, trial, times_s))
    try:
        for time_s in times_s:
            pixels, state = next(shown), trial.state_at(time_s)
            lay_in_corner(pixels, next(shown))
            touched = f"{len(state.training.touches)}/{len(task.labels)}"
            text = f"{touched}   {clock(state.completion_time)}"
            for color, width in (((20, 20, 20), 6), ((255, 255, 255), 2)):
                cv2.putText(
                    pixels, text, (32, 58), cv2.FONT_HERSHEY_DUPLEX, 1.2, color, width, cv2.LINE_AA
                )
            yield pixels
    finally:
        shown.close()


def _shots(
    renderer: vtkRenderer,
    setup: SimulationSetup,
    task: Task,
    trial: RecordedTrial,
    times_s: Sequence[float],
) -> Iterator[tuple[Camera, tuple[int, int]]]:
    """Show the trial at each time; yield its camera and the corner's, each with its size."""
    scenario = setup.scenario
    camera, corner = scenario.cameras[CLOSE_UP], (round(INSET_SHARE * each) for each in SIZE)
    far = scenario.cameras[FAR], (next(corner), next(corner))
    head = read_head_mesh(scenario.head)
    nodes = scene_nodes(scenario, setup.robot, head, task)
    best_views, view, point_in_view = TouchViews(setup, head), ViewControl(), None
    best_views.begin(task, transforms.in_millimeters(trial.state_at(0.0).head_to_world))
    shown_looks: dict[str, Material] = {}
    actors: dict[str, list[vtkActor]] = {}
    for state in map(trial.state_at, times_s):
        training = state.training
        poses = dict(zip(BODIES[:-1], state.body_poses, strict=True))
        touched = (touch.label for touch in training.touches)
        looks = looks_of(touched, training.next_point, state.proximity)
        if looks != shown_looks:
            shown_looks = looks
            renderer.RemoveAllViewProps()
            actors = {node.name: node_actors([node], poses, looks) for node in nodes}
            for actor in chain.from_iterable(actors.values()):
                renderer.AddActor(actor)
        for name, pose in poses.items():
            for actor in actors.get(name, ()):
                actor.SetUserMatrix(vtk_matrix(pose))
        # The camera is on its way to the best view of the next fiducial.
        if training.next_point is not None and training.next_point != point_in_view:
            point_in_view = training.next_point
            best = best_views.best(point_in_view, state.q)
            if best is not None:
                view.go(orbit_to(camera, best.eye, best.fiducial))
        view.advance(1.0 / RATE_HZ, camera, STILL, is_arm_still=True)
        seen = camera_pose(camera, view.orbit)
        position, focal_point = (
            MM_PER_M * np.array(place) for place in (seen.position, seen.focal_point)
        )
        yield Camera(position, focal_point, np.array(seen.view_up), seen.view_angle_deg), SIZE
        yield far
