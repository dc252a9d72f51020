"""`rastrainer scenario`: preview, check and unpack, and what is left of a build by Ctrl-C."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import zipfile
from dataclasses import replace

import pytest

from rastrainer.head.mesh import read_head_mesh
from rastrainer.scenario.library import pack, user_library
from rastrainer.scenario.scenario import load_scenario
from rastrainer.scenario.writer import new_folder, write_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.cli.main import main
from Testing.domain.scenario.made_up_scenario import ball_head, made_up_scenario, png
from Testing.read_png import read_png
from Testing.slicer.head.phantoms import phantom
from Testing.slicer.head.volume_file import write_volume

RASTRAINER = [sys.executable, "-m", "rastrainer_simulator.cli.main", "scenario"]


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


@pytest.mark.soak
def test_a_head_is_previewed_before_anything_is_made_from_it(volume, tmp_path, capsys):
    picture = tmp_path / "head.png"
    assert main(["scenario", "preview", str(volume), str(picture), "--cut=-30"]) == 0
    assert "cut flat at -30.0 mm" in capsys.readouterr().out
    pixels = read_png(picture)
    assert pixels.shape == (480, 640, 3)
    assert pixels.std() > 20.0


def test_a_missing_head_has_no_picture(volume, tmp_path, capsys):
    words = ["scenario", "preview", str(volume), str(tmp_path / "head.png"), "--cut=500"]
    assert main(words) == 2
    assert "its base must be in this range, not at 500 mm" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == [volume.name]


def test_the_check_reports_each_problem_and_reflects_it_in_its_exit_status(ball, tmp_path, capsys):
    assert main(["scenario", "check", str(ball)]) == 1
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) > 3
    assert all(line.endswith(".") for line in printed)
    assert any("off the skin" in line for line in printed)
    assert main(["scenario", "check", str(tmp_path / "none")]) == 2
    assert "none does not exist" in capsys.readouterr().err


def test_the_check_names_the_fiducials_that_no_view_shows(tmp_path, monkeypatch, capsys):
    scenario = load_scenario(asset_path("scenarios", "colin27"))
    with new_folder(tmp_path / "head") as made:
        one = replace(scenario, tasks=scenario.tasks[1:2], procedures=())
        write_scenario(made, one, read_head_mesh(scenario.head))
        (made / "preview.png").write_bytes(png())
    monkeypatch.setattr("rastrainer_simulator.viewpoint.best_view.WIDEST_DEG", 0.0)
    assert main(["scenario", "check", str(tmp_path / "head")]) == 1
    printed = capsys.readouterr().out.splitlines()
    unseen = [line for line in printed if "cannot be seen within 60° of the skin's normal" in line]
    assert len(unseen) == 1, printed
    assert unseen[0].startswith("Task 1: fiducials 1, 2, 3,")


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


def test_a_package_that_escapes_its_folder_is_refused_and_changes_nothing(tmp_path, capsys):
    bad, library = tmp_path / "bad.zip", tmp_path / "deep" / "library"
    with zipfile.ZipFile(bad, "w") as archive:
        archive.writestr("../../evil.txt", "x")
    assert main(["scenario", "unpack", str(bad), "--library", str(library)]) == 2
    assert "holds a file with the path" in capsys.readouterr().err
    assert sorted(tmp_path.iterdir()) == [bad]


@pytest.mark.skipif(os.name == "nt", reason="Windows has other signals")
def test_a_build_interrupted_by_ctrl_c_leaves_nothing(volume, tmp_path):
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    words = [*RASTRAINER, "build", str(volume), "-o", str(tmp_path / "made")]
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
