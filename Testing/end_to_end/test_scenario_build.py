"""Scenarios by the real processes: checked, unpacked and loaded; ended builds leave nothing."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile

import pytest

from rastrainer.scenario.library import pack, user_library
from rastrainer.scenario.writer import new_folder, write_scenario
from rastrainer_simulator.authoring.make import head_process
from rastrainer_simulator.cli.main import main
from Testing.domain.scenario.made_up_scenario import ball_head, made_up_scenario, png
from Testing.slicer.head.phantoms import CT, phantom
from Testing.slicer.head.volume_file import write_volume

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
