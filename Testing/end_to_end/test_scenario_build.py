"""Scenarios by the real processes: checked, unpacked and loaded; ended builds leave nothing."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile

import numpy as np
import pytest

from rastrainer.head.mesh import HeadMesh
from rastrainer.igtl.client import Client
from rastrainer.scenario.library import pack, user_library
from rastrainer.scenario.scenario import load_scenario
from rastrainer.scenario.writer import HeadDraft, new_folder, write_scenario
from rastrainer.sections.new_scenario_logic import HEAD_SHARE, planScenario
from rastrainer_simulator.authoring.make import head_process
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.virtual.scripted_trial import send_hello
from Testing.domain.head.spheres import sphere_mesh
from Testing.domain.scenario.made_up_scenario import ball_head, made_up_scenario, png
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.slicer.head.phantoms import CT, phantom
from Testing.slicer.head.volume_file import write_volume
from Testing.slicer.simulator_double import wait_until

RASTRAINER = [sys.executable, "-m", "rastrainer_simulator.cli.main"]


@pytest.fixture
def volume(tmp_path):
    return write_volume(tmp_path / "head.nii.gz", phantom(spacing=(3.0, 3.0, 3.0), size=0.75))


@pytest.fixture
def ball(tmp_path):
    """A scenario with unusable tasks, whose fiducials are inside the head or outside it."""
    with new_folder(tmp_path / "ball") as made:
        write_scenario(made, made_up_scenario(), ball_head())
        (made / "preview.png").write_bytes(png())
    return tmp_path / "ball"


def test_the_check_reports_each_problem_and_reflects_it_in_its_exit_status(ball, tmp_path, capsys):
    assert main(["scenario", "check", str(ball)]) == 1
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) > 3
    assert all(line.endswith(".") for line in printed)
    assert any("off the skin" in line for line in printed)
    assert main(["scenario", "check", str(tmp_path / "none")]) == 2
    assert "none does not exist" in capsys.readouterr().err


def test_a_package_is_unpacked_into_the_library_once(ball, tmp_path, monkeypatch, capsys):
    for name in ("HOME", "USERPROFILE"):
        monkeypatch.setenv(name, str(tmp_path / "home"))
    package = pack(ball, tmp_path / "ball.zip")
    assert main(["scenario", "unpack", str(package)]) == 0
    assert capsys.readouterr().out.strip() == str(user_library() / "ball")
    assert (user_library() / "ball" / "scenario.json").is_file()
    before = sorted(user_library().rglob("*"))
    assert main(["scenario", "unpack", str(package)]) == 2
    assert "already" in capsys.readouterr().err
    assert sorted(user_library().rglob("*")) == before


@pytest.mark.skipif(os.name == "nt", reason="Windows has other signals")
def test_a_build_interrupted_by_ctrl_c_leaves_nothing(volume, tmp_path):
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    words = [*RASTRAINER, "scenario", "build", str(volume), "-o", str(tmp_path / "made")]
    # A terminal sends the signal to all processes in front of it, which a new session stands for.
    build = subprocess.Popen(
        words,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"TMPDIR": str(temporary)},
        start_new_session=True,
        # A suite that runs in the background ignores Ctrl-C, which its children would inherit.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    with build:
        assert "Reading the volume" in build.stdout.readline()
        assert list(temporary.iterdir())
        os.killpg(build.pid, signal.SIGINT)
        said = build.stderr.read()
    assert build.returncode == 130
    assert "Traceback" not in said
    assert not list(temporary.iterdir())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["head.nii.gz", "temporary"]


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


@pytest.fixture
def environment(tmp_path, monkeypatch):
    """A separate home for the user, here and in the processes."""
    for name in ("HOME", "USERPROFILE"):
        monkeypatch.setenv(name, str(tmp_path))
    return dict(os.environ)


def trains_on(port, name, title):
    """Load a scenario by its name into a running simulator, and begin a trial on it."""
    with Client(port=port) as client:
        send_hello(client, "test")
        loaded = client.send_command("LoadScenario", {"folder": name}, timeout=60)
        assert (loaded.ok, loaded.error) == (True, "")
        assert dict(loaded.data) == {"name": name, "title": title}
        listed = client.send_command("ListTasks", {}, timeout=60)
        assert listed.data["scenario"] == name
        task = listed.data["tasks"][0]["name"]
        started = client.send_command("StartTask", {"task": task, "trainee": "anna"}, timeout=60)
        assert (started.ok, started.error) == (True, "")
        state = client.wait_for(
            "SimState", lambda message: json.loads(message.content.text)["phase"] == "running", 60
        )
        assert json.loads(state.content.text)["task"] == task


def test_a_scenario_from_the_library_is_loaded_by_name_and_trained_on(environment, tmp_path):
    with new_folder(user_library() / "ball") as made:
        write_scenario(made, made_up_scenario(), ball_head())
    options = ("--no-views", "--no-gamepad")
    with SimulatorProcess(tmp_path / "records", *options, env=environment) as simulator:
        trains_on(simulator.port, "ball", "A ball")
