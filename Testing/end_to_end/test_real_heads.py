"""Whole scenarios of an MRI and a CT of real people, which Debian has; none of them is shipped."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from scipy import sparse

from rastrainer.head.mesh import read_head_mesh
from rastrainer.scenario.scenario import load_scenario
from Testing.slicer.head.debian_heads import COLIN27, CT_PROJECT, write_ct

pytestmark = pytest.mark.soak
RASTRAINER = [sys.executable, "-m", "rastrainer_simulator.cli.main", "scenario"]
MISSING = "{path} is missing; install it: sudo apt-get install {package}"


@pytest.fixture
def ct(tmp_path):
    """The CT, as a file that Slicer reads."""
    assert CT_PROJECT.is_file(), MISSING.format(path=CT_PROJECT, package="invesalius-examples")
    return write_ct(tmp_path / "ct.nrrd")


@pytest.fixture
def mri():
    """The MRI Colin27."""
    assert COLIN27.is_file(), MISSING.format(path=COLIN27, package="mricron-data")
    return COLIN27


@pytest.mark.parametrize(("volume", "kind"), [("mri", "approximation"), ("ct", "bone")])
def test_a_real_head_becomes_a_sound_scenario(request, tmp_path, volume, kind):
    path, folder = request.getfixturevalue(volume), tmp_path / "made"
    subprocess.run([*RASTRAINER, "build", str(path), "-o", str(folder)], check=True)
    scenario = load_scenario(folder)
    mesh = read_head_mesh(scenario.head)
    assert mesh.is_closed
    assert mesh.euler_characteristic == 2
    assert body_count(mesh) == 1
    assert len(mesh.triangles) <= 60_000
    assert scenario.skull.kind.value == kind
    extent = np.ptp(mesh.vertices, axis=0)
    assert (extent > [130, 160, 120]).all()
    # Upright: the widest part is nearer to the base than the crown is.
    widest = mesh.vertices[np.abs(mesh.vertices[:, 0] - mesh.centroid[0]).argmax(), 2]
    assert widest < mesh.centroid[2] + 0.25 * extent[2]
    assert len(scenario.tasks) == 6
    checked = subprocess.run([*RASTRAINER, "check", str(folder)], capture_output=True, text=True)
    assert checked.returncode == 0, checked.stdout


def body_count(mesh):
    ends = mesh.edges.T
    graph = sparse.coo_matrix((np.ones(ends.shape[1]), tuple(ends)), (len(mesh.vertices),) * 2)
    return sparse.csgraph.connected_components(graph, directed=False)[0]
