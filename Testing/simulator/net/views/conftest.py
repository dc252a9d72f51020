"""A view server with a real control loop, and views that join it."""

from __future__ import annotations

import asyncio

import pytest

from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.net.views import view_server as view_server_module
from rastrainer_simulator.presentation.messages import ViewRole
from rastrainer_simulator.scene.scene_files import NO_TASK, SceneFiles, scenes_folder
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import ServedViews, ViewClient


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory, setup):
    """Give the tests their own cache of scenes, which has the scene without a task."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        asyncio.run(SceneFiles(scenes_folder()).scene(setup, NO_TASK))
        yield


@pytest.fixture(scope="module")
def control_loop(tmp_path_factory, setup) -> ControlLoop:
    simulation = Simulation(setup, seed=4)
    with ControlLoop(simulation, tmp_path_factory.mktemp("records")) as control_loop:
        yield control_loop


@pytest.fixture(autouse=True)
def no_page(monkeypatch):
    """Pretend that there is no built page, whether this checkout has one or not."""
    monkeypatch.setattr(view_server_module, "page_folder", lambda: None)


@pytest.fixture
def serve(loop_thread, control_loop):
    """Starts view servers with given limits, and ends them."""
    started = []

    def start(**limits) -> ServedViews:
        started.append(ServedViews(loop_thread, control_loop, **limits))
        return started[-1]

    yield start
    for served in started:
        served.close()


@pytest.fixture
def served(serve) -> ServedViews:
    return serve()


@pytest.fixture
def connect():
    """Connects views to a server, each with its own key, and closes them."""
    views = []

    def connect_one(served: ServedViews, role: ViewRole = ViewRole.VIEW) -> ViewClient:
        views.append(ViewClient(thread, served.url, served.new_key(role)))
        return views[-1]

    with LoopThread() as thread:
        yield connect_one
        for view in views:
            view.__exit__()
