"""The window's real picture of touches behind the head, as a trainee makes them."""

import numpy as np
import pytest

from rastrainer.protocol import Mode
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.desktop.inbox import Inbox, LoadedScene, Viewpoint, read_parts
from rastrainer_simulator.desktop.picture import Picture
from rastrainer_simulator.desktop.viewports import Quality
from rastrainer_simulator.flow.session.trial_view import along_skin
from rastrainer_simulator.net.views.outgoing import BODIES, scene_news, state_news
from rastrainer_simulator.presentation.messages import CoveringBodies, message_text
from rastrainer_simulator.presentation.screen import Screen
from rastrainer_simulator.scene.scene_glb import scene_glb
from rastrainer_simulator.state import EventKind
from rastrainer_simulator.teleoperation.steering import AxesChoice
from rastrainer_simulator.vectors import vector
from rastrainer_simulator.viewpoint.best_view import TouchViews
from rastrainer_simulator.viewpoint.view_control import Pictures, camera_pose, orbit_to
from rastrainer_simulator.virtual.play import play_virtual_trial
from rastrainer_simulator.virtual.scripted_trainee import Skill
from Testing.simulator.desktop.conftest import SIZE

TASK, SEED, STEP_S = "task-5", 3, 0.05
BEHIND = ("9", "10", "11", "12", "13", "14", "15")
NEXT_COLOR = ((250, 215, 60), (255, 255, 200))
MIDDLE = 40
"""Half the side of the square about the main picture's middle, pixels: the fiducial is there."""


@pytest.fixture(scope="module")
def trial(setup):
    """A trial of the task, and the states in which its points were touched, by their labels."""
    states = {}

    def watch(_simulation, before, _operator_input, result):
        for event in result.events:
            if event.kind is EventKind.TOUCH:
                states[event.data["label"]] = before

    skill, mode = Skill(slip_at=None), Mode.DESKTOP
    simulation = Simulation(setup, 0)
    played = play_virtual_trial(simulation, TASK, SEED, skill, STEP_S, watch, "P01", mode, "trial")
    return played, states


@pytest.fixture(scope="module")
def views(setup, trial):
    return dict(TouchViews(setup).of(setup.scenario.task(TASK), trial[0].head_to_world))


@pytest.fixture(scope="module")
def inbox(setup):
    inbox = Inbox()
    inbox.bodies, inbox.screen, inbox.problem = BODIES, Screen(), ""
    content = scene_glb(setup.scenario, setup.robot, setup.scenario.task(TASK))
    news = scene_news("0" * 64, setup.scenario, TASK, AxesChoice.CAMERA)
    inbox.scene = LoadedScene(
        read_parts(content, BODIES),
        {name: Viewpoint.of(camera) for name, camera in news.cameras.items()},
        news.fiducials,
    )
    return inbox


@pytest.fixture(scope="module")
def show(gl_window, inbox):
    """Return a function that shows a state through cameras, and returns the pixels."""
    picture = Picture(gl_window, inbox, Quality.LOW)
    times = iter(np.arange(0.0, 1e4, 10.0))

    def show(state, pictures):
        inbox.take_state(message_text(state_news(state, 0, pictures, CoveringBodies())))
        for now in (float(next(times)), float(next(times))):
            picture.is_due(now)
        picture.draw()
        return gl_window.pixels().astype(int), picture.viewports.inset_box

    yield show
    for renderer in list(gl_window.render_window.GetRenderers()):
        gl_window.render_window.RemoveRenderer(renderer)


def count_of_next(pixels):
    """Return how many pixels have the color of the next fiducial."""
    low, high = NEXT_COLOR
    red, green, blue = np.moveaxis(pixels, -1, 0)
    is_between = ((pixels >= low) & (pixels <= high)).all(axis=-1)
    return int((is_between & (red >= green) & (green > blue + 40)).sum())


@pytest.mark.parametrize("label", BEHIND)
def test_the_best_view_shows_a_fiducial_during_its_touch_where_the_default_views_did_not(
    setup, trial, views, show, label
):
    state, view, cameras = trial[1][label], views[label], setup.scenario.cameras
    tip = vector(state.tool_tip_to_world[:3, 3].tolist())
    best = Pictures(
        camera_pose(cameras["close-up"], orbit_to(cameras["close-up"], view.eye, view.fiducial)),
        along_skin(view.beside, view.fiducial, tip),
    )
    pixels, box = show(state, best)
    x, y = SIZE[0] // 2, SIZE[1] // 2
    assert count_of_next(pixels[y - MIDDLE : y + MIDDLE, x - MIDDLE : x + MIDDLE]) > 20
    inset = pixels[box.top : box.top + box.height, box.left : box.left + box.width]
    assert count_of_next(inset) > 5
    for camera in cameras.values():
        assert count_of_next(show(state, Pictures(camera_pose(camera)))[0]) == 0
