"""A small cohort that was actually played, and copies of it to change."""

import shutil
import subprocess
import sys

import pytest

from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer_simulator.virtual.cohort import simulate_cohort
from rastrainer_simulator.virtual.hand import Skill
from rastrainer_simulator.virtual.play import PlaySettings
from rastrainer_simulator.virtual.population import ModeEffect, Population
from Testing.end_to_end.simulator_process import SERVES, paired_key
from Testing.simulator.net.views.served import ViewClient

BRISK = Skill(speed_mm_s=300.0, gain_per_s=6.0, reaction_s=0.1, dwell_s=0.04, slip_at=None)
AIM_FACTOR = 2.5


@pytest.fixture(scope="session")
def protocol():
    return StudyProtocol(
        "small", "A small cohort", ("desktop", "hmd"), "balanced", ("task-1",), "fixed"
    )


@pytest.fixture(scope="session")
def population():
    return Population(
        skill=BRISK, aim_spread=0.0, learning=0.0, modes={"hmd": ModeEffect(aim=AIM_FACTOR)}
    )


@pytest.fixture(scope="session")
def played(tmp_path_factory, protocol, population):
    """The folder of a cohort of two trainees with one task in two modes, with journals."""
    folder = tmp_path_factory.mktemp("cohort") / "study"
    run = simulate_cohort(
        protocol, population, 2, 7, folder, PlaySettings(), with_journals=True, workers=1
    )
    assert (run.played, run.stuck) == (4, 0)
    return folder


@pytest.fixture
def copied(played, tmp_path):
    """A copy of that folder, to change."""
    shutil.copytree(played, tmp_path / "study")
    return tmp_path / "study"


@pytest.fixture
def serving(loop_thread):
    """Starts a command that serves views; returns its process, its lines and a joined page."""
    started = []

    def start(*words):
        command = [sys.executable, "-m", "rastrainer_simulator.cli.main", *map(str, words)]
        process = subprocess.Popen(
            [*command, "--no-window", "--view-port", "0"], stdout=subprocess.PIPE, text=True
        )
        lines, served = [], None
        while served is None:
            lines.append(process.stdout.readline())
            assert lines[-1], lines
            served = SERVES.search(lines[-1].strip())
        view = ViewClient(loop_thread, served[1], paired_key(*served.groups()))
        view.join()
        started.append((process, view))
        return process, lines, view

    yield start
    for process, view in started:
        view.__exit__()
        process.kill()
        process.wait()
        process.stdout.close()
