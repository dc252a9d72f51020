"""The options of a scenario on the command line: used as given, or refused with a sentence."""

import json

import numpy as np
import pytest

from rastrainer.head.trial_head import Perturbation
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.authoring import make
from rastrainer_simulator.cli.main import command_parser, main
from rastrainer_simulator.cli.scenario import options_of
from Testing.domain.scenario.made_up_scenario import png


def wished(*words):
    given = ["scenario", "tasks", "draft", *words]
    return options_of(command_parser().parse_args(given), "the volume")


def test_every_given_option_is_used(tmp_path):
    (tmp_path / "setup.json").write_text(
        json.dumps({"head": {"yawDeg": 20}, "perturbation": {"tiltDeg": 1}})
    )
    wishes = wished(
        *("-o", "x", "--title", "Ms X", "--source", "clinic", "--license", "CC0", "--seed", "7"),
        *("--target", "Tumor", "1", "-2", "3.5", "--target", "Cyst", "4", "5", "6"),
        *("--trajectory", "Biopsy", "0", "0", "90", "1", "2", "3"),
        *("--setup", str(tmp_path / "setup.json"), "--tasks", "a.mrk.json", "b.mrk.json"),
    )
    assert (wishes.title, wishes.source, wishes.license) == ("Ms X", "clinic", "CC0")
    assert [target.name for target in wishes.targets] == ["Tumor", "Cyst"]
    assert np.array_equal(wishes.targets[0].position_ras, [1.0, -2.0, 3.5])
    assert wishes.trajectory.name == "Biopsy"
    assert np.array_equal(wishes.trajectory.entry_ras, [0.0, 0.0, 90.0])
    assert np.array_equal(wishes.trajectory.target_ras, [1.0, 2.0, 3.0])
    assert wishes.setup.head.yaw_deg == 20.0
    assert wishes.setup.perturbation == Perturbation(15.0, 8.0, 1.0)
    assert [path.name for path in wishes.task_files] == ["a.mrk.json", "b.mrk.json"]
    assert wishes.seed == 7


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--title", "x" * 81], "--title must be printable text of 1 to 80"),
        (["--title", "§§"], "cannot be a scenario's title"),
        (["--target", "T", "1", "two", "3"], "--target needs numbers after its name"),
        (["--target", "T", "1", "2", "2001"], "--target must be within ±2000 mm"),
        (["--setup", "{}/bad.json"], 'there is no "haed"; use head'),
    ],
)
def test_an_unusable_option_is_reported_in_one_sentence_and_nothing_is_made(
    tmp_path, capsys, words, sentence
):
    (tmp_path / "bad.json").write_text('{"haed": {}}')
    words = [word.replace("{}", str(tmp_path)) for word in words]
    before = sorted(tmp_path.rglob("*"))
    out = str(tmp_path / "made")
    assert main(["scenario", "tasks", str(tmp_path / "no-draft"), "-o", out, *words]) == 2
    (said,) = capsys.readouterr().err.splitlines()
    assert sentence in said
    assert sorted(tmp_path.rglob("*")) == before


COLIN27 = asset_path("scenarios", "colin27")
ENTRY, INSIDE = ("0", "-20", "100"), ("2", "-15", "5")


def copied(copy, *words):
    """Return the status of the command that copies the default scenario with a plan."""
    return main(["scenario", "plan", str(COLIN27), "-o", str(copy), *words])


def test_a_copy_with_a_trajectory_keeps_head_tasks_target_and_provenance(tmp_path, monkeypatch):
    monkeypatch.setattr(make, "draw_preview", lambda path, *_: path.write_bytes(png()))
    words = ("--title", "With a biopsy", "--trajectory", "Biopsy", *ENTRY, *INSIDE)
    assert copied(tmp_path / "copy", *words) == 0
    before, copy = load_scenario(COLIN27), load_scenario(tmp_path / "copy")
    assert (copy.name, copy.title) == ("with-a-biopsy", "With a biopsy")
    assert (copy.trajectory.name, copy.trajectory.entry_ras.tolist()) == ("Biopsy", [0, -20, 100])
    assert copy.head.read_bytes() == before.head.read_bytes()
    assert copy.volume.file.read_bytes() == before.volume.file.read_bytes()
    assert (copy.volume.window, copy.volume.level) == (before.volume.window, before.volume.level)
    assert copy.target.position_ras.tolist() == before.target.position_ras.tolist()
    assert copy.provenance == before.provenance
    for task, same in zip(copy.tasks, before.tasks, strict=True):
        assert np.array_equal(task.fiducials, same.fiducials)
    assert copy.preview is not None


@pytest.mark.soak
def test_a_copy_with_targets_reports_the_error_at_the_first(tmp_path):
    words = ("--target", "Tumor", *INSIDE, "--target", "Cyst", "20", "0", "20")
    assert copied(tmp_path / "copy", *words) == 0
    copy = load_scenario(tmp_path / "copy")
    assert (copy.target.name, copy.target.position_ras.tolist()) == ("Tumor", [2, -15, 5])
    assert [target.name for target in copy.targets] == ["Cyst"]
