"""A small cohort that was actually played, and copies of it to change."""

import shutil

import pytest

from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer_simulator.virtual.cohort import simulate_cohort
from rastrainer_simulator.virtual.hand import Skill
from rastrainer_simulator.virtual.play import PlaySettings
from rastrainer_simulator.virtual.population import ModeEffect, Population

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
