"""Building scenarios through the real processes: what is broken or cancelled leaves nothing."""

import subprocess
import sys

import numpy as np
import pytest

from rastrainer.head_mesh import HeadMesh
from rastrainer.scenario_draft import HeadDraft
from rastrainer.slicer.head.scenario_build import BuildRequest, finish_scenario
from rastrainer.slicer.head.volume import Volume
from Testing.domain.spheres import sphere_mesh

RASTRAINER = [sys.executable, "-m", "rastrainer_simulator.cli"]


def test_a_file_that_is_no_volume_ends_the_build_with_one_sentence(tmp_path):
    (tmp_path / "noise.nrrd").write_bytes(b"no image" * 100)
    words = ["scenario", "build", str(tmp_path / "noise.nrrd"), "-o", str(tmp_path / "made")]
    build = subprocess.run([*RASTRAINER, *words], capture_output=True, text=True)
    assert build.returncode == 2
    assert "noise.nrrd could not be read as a volume" in build.stderr.splitlines()[-1]
    assert [path.name for path in tmp_path.iterdir()] == ["noise.nrrd"]


def test_a_build_that_is_cancelled_leaves_nothing(tmp_path):
    class CancelledError(Exception):
        pass

    def progress(step, _share):
        if step == "Finding what the robot can touch":
            raise CancelledError

    sphere = sphere_mesh(3)
    vertices = np.maximum(sphere.vertices, [-np.inf, -np.inf, -70.0])
    draft = HeadDraft(HeadMesh(vertices, sphere.triangles), "made up")
    volume = Volume(np.zeros((1, 1, 1)), np.eye(4))
    request = BuildRequest(volume, tmp_path / "made", "made up", "none needed")
    with pytest.raises(CancelledError):
        finish_scenario(draft, request, RASTRAINER, progress=progress)
    assert not list(tmp_path.iterdir())
