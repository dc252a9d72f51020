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


@pytest.mark.parametrize(
    ("path", "package", "kind"),
    [
        pytest.param(COLIN27, "mricron-data", "approximation", id="mri"),
        pytest.param(CT_PROJECT, "invesalius-examples", "bone", id="ct"),
    ],
)
def test_a_real_head_becomes_a_sound_scenario(tmp_path, path, package, kind):
    assert path.is_file(), f"{path} is missing; install it: sudo apt-get install {package}"
    path, folder = write_ct(tmp_path / "ct.nrrd") if kind == "bone" else path, tmp_path / "made"
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
