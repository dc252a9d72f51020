"""Scenarios built through the real processes: a broken or canceled build leaves nothing."""

import subprocess
import sys
import tempfile

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.scenario.scenario import SkullKind, load_scenario
from rastrainer.scenario.writer import HeadDraft, new_folder, write_scenario
from rastrainer.sections.new_scenario_logic import HEAD_SHARE, planScenario
from rastrainer_simulator.authoring.make import head_process
from Testing.domain.head.spheres import sphere_mesh
from Testing.domain.scenario.made_up_scenario import ball_head, made_up_scenario
from Testing.slicer.head.phantoms import CT, phantom
from Testing.slicer.head.volume_file import write_volume
from Testing.slicer.simulator_double import wait_until

RASTRAINER = [sys.executable, "-m", "rastrainer_simulator.cli.main"]


class CanceledError(Exception):
    """The scenario is no longer wanted."""


@pytest.fixture(scope="module")
def ct(tmp_path_factory):
    """A CT of a head, as a file."""
    scan = phantom(CT, spacing=(2.0, 2.0, 2.0), lowest=-46.0, size=0.75)
    return write_volume(tmp_path_factory.mktemp("ct") / "ct.nrrd", scan)


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """The folder in which temporary files are made, here and in the processes."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    monkeypatch.setenv("TMPDIR", str(folder))
    return folder


def wait_for_head(process):
    return process.head(lambda _step, _share: None, lambda _warning: None)


@pytest.mark.soak
def test_a_head_can_be_worked_on_before_its_skull_is_made(ct):
    with head_process(ct, []) as process:
        first = wait_for_head(process)
        assert first.skull is None
        assert "Skull" not in first.method
        whole = process.whole()
    assert np.array_equal(whole.head.vertices, first.head.vertices)
    assert np.array_equal(whole.head.triangles, first.head.triangles)
    assert len(whole.skull.triangles) > 1000
    assert whole.skull.kind is SkullKind.BONE
    assert whole.method == f"{first.method} Skull: bone of the CT."


@pytest.mark.soak
def test_a_ct_without_bone_is_refused_with_a_message_if_its_skull_is_requested(tmp_path):
    soft = phantom({**CT, "bone": CT["scalp"]}, spacing=(2.0, 2.0, 2.0), lowest=-46.0, size=0.75)
    with head_process(write_volume(tmp_path / "soft.nrrd", soft), []) as process:
        assert wait_for_head(process).head.is_closed
        with pytest.raises(InputError, match="The CT shows no bone"):
            process.whole()


def test_canceling_also_ends_the_process_that_extracts_the_head(ct, temporary, monkeypatch):
    started = []

    class Recorded(subprocess.Popen):
        def __init__(self, *words, **options):
            super().__init__(*words, **options)
            started.append(self)

    def progress(_step, _share):
        raise CanceledError

    monkeypatch.setattr(subprocess, "Popen", Recorded)
    with pytest.raises(CanceledError), head_process(ct, []) as process:
        process.head(progress, lambda _warning: None)
    assert [process.returncode in (None, 0) for process in started] == [False]
    assert not list(temporary.iterdir())


PLANNER = """
import shutil, sys
print(" 50%  Placing fiducials\\nWarning: The tumor lies too deep.\\n100%  Done")
shutil.copytree({made!r}, sys.argv[sys.argv.index("-o") + 1])
"""


def test_warnings_of_the_planner_are_shown_beside_those_of_the_head(tmp_path):
    made = tmp_path / "made"
    with new_folder(made) as folder:
        write_scenario(folder, made_up_scenario(), ball_head())
    (tmp_path / "planner.py").write_text(PLANNER.format(made=str(made)))
    warnings = planScenario(
        lambda _tell: (HeadDraft(ball_head(), "made up"), ["The slices are far apart."]),
        tmp_path / "built",
        (),
        [sys.executable, str(tmp_path / "planner.py")],
    )
    assert load_scenario(tmp_path / "built").folder == tmp_path / "built"
    assert warnings == ["The slices are far apart.", "The tumor lies too deep."]


def test_a_canceled_build_leaves_nothing(tmp_path):
    def progress(_step, share):
        # At the planner's second step, or at the next that is seen.
        if share > HEAD_SHARE:
            raise CanceledError

    sphere = sphere_mesh(3)
    vertices = np.maximum(sphere.vertices, [-np.inf, -np.inf, -70.0])
    draft = HeadDraft(HeadMesh(vertices, sphere.triangles), "made up")
    with pytest.raises(CanceledError):
        planScenario(
            lambda _tell: (draft, []), tmp_path / "made", (), RASTRAINER, progress=progress
        )
    # The planning process removes its partial results, and ends.
    wait_until(lambda: not list(tmp_path.iterdir()), lambda: None, 60.0)
