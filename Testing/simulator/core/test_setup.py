"""The built-in robot is loaded from its prepared JSON; a scenario's volume is ignored."""

import os
import shutil
import subprocess
import sys

import pytest

from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.core.simulation import Simulation


def test_a_simulator_starts_without_the_packages_that_read_meshes_draw_and_report():
    script = (
        "import sys, rastrainer_simulator.cli.simulator, rastrainer_simulator.server.server\n"
        "import rastrainer_simulator.net.views.view_server\n"
        "import rastrainer_simulator.flow.flow_presenter\n"
        "from rastrainer_simulator.core.setup import load_setup; load_setup()\n"
        "names = {name.partition('.')[0] for name in sys.modules}\n"
        "unwanted = {'trimesh', 'yourdfpy', 'scipy', 'matplotlib', 'jinja2', 'vtk', 'vtkmodules'}\n"
        "print(names & unwanted)"
    )
    found = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert found.stdout.strip() == "set()", found.stderr


def missing(path):
    path.unlink()


def endless(path):
    path.unlink()
    os.mkfifo(path)


KINDS = [missing, *([endless] if hasattr(os, "mkfifo") else [])]


@pytest.mark.parametrize("broken", KINDS)
def test_a_simulation_starts_without_the_volume_and_the_check_names_it(tmp_path, capsys, broken):
    folder = tmp_path / "scenario"
    shutil.copytree(asset_path("scenarios", "colin27"), folder)
    broken(folder / "volume.nrrd")
    simulation = Simulation(load_setup(folder), seed=1)
    assert simulation.setup.scenario.volume.file == (folder / "volume.nrrd").resolve()
    assert main(["scenario", "check", str(folder)]) == 2
    assert "volume.nrrd" in capsys.readouterr().err
