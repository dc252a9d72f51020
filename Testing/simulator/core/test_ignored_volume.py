"""The simulator ignores a scenario's volume: a broken one hinders nobody, but `check` names it."""

import os
import shutil

import pytest

from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.core.simulation import Simulation


def missing(path):
    path.unlink()


def not_an_image(path):
    path.write_bytes(b"no image")


def endless(path):
    path.unlink()
    os.mkfifo(path)


KINDS = [missing, not_an_image, *([endless] if hasattr(os, "mkfifo") else [])]


@pytest.mark.parametrize("broken", KINDS)
def test_a_simulation_starts_without_the_volume_and_the_check_names_it(tmp_path, capsys, broken):
    folder = tmp_path / "scenario"
    shutil.copytree(asset_path("scenarios", "colin27"), folder)
    broken(folder / "volume.nrrd")
    simulation = Simulation(load_setup(folder), seed=1)
    assert simulation.setup.scenario.volume.path == (folder / "volume.nrrd").resolve()
    assert main(["scenario", "check", str(folder)]) == 2
    assert "volume.nrrd" in capsys.readouterr().err
