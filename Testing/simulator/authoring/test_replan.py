"""A head gets another plan: a copy of its scenario, checked like a new one."""

import numpy as np
import pytest

from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.cli.main import main

COLIN27 = asset_path("scenarios", "colin27")
ENTRY, INSIDE = ("0", "-20", "100"), ("2", "-15", "5")


def copied(copy, *words):
    """Return the status of the command that copies the default scenario with a plan."""
    return main(["scenario", "plan", str(COLIN27), "-o", str(copy), *words])


def test_a_copy_with_a_trajectory_keeps_head_tasks_target_and_provenance(tmp_path):
    words = ("--title", "With a biopsy", "--trajectory", "Biopsy", *ENTRY, *INSIDE)
    assert copied(tmp_path / "copy", *words) == 0
    before, copy = load_scenario(COLIN27), load_scenario(tmp_path / "copy")
    assert (copy.name, copy.title) == ("with-a-biopsy", "With a biopsy")
    assert (copy.trajectory.name, copy.trajectory.entry.tolist()) == ("Biopsy", [0, -20, 100])
    assert copy.head_mesh.read_bytes() == before.head_mesh.read_bytes()
    assert copy.volume.path.read_bytes() == before.volume.path.read_bytes()
    assert (copy.volume.window, copy.volume.level) == (before.volume.window, before.volume.level)
    assert copy.target_position.tolist() == before.target_position.tolist()
    assert copy.provenance == before.provenance
    for task, same in zip(copy.tasks, before.tasks, strict=True):
        assert np.array_equal(task.fiducials, same.fiducials)
    assert copy.preview is not None


def test_a_copy_with_targets_reports_the_error_at_the_first(tmp_path):
    words = ("--target", "Tumor", *INSIDE, "--target", "Cyst", "20", "0", "20")
    assert copied(tmp_path / "copy", *words) == 0
    copy = load_scenario(tmp_path / "copy")
    assert (copy.target_name, copy.target_position.tolist()) == ("Tumor", [2, -15, 5])
    assert [target.name for target in copy.targets] == ["Cyst"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--trajectory", "Biopsy", "0", "-20", "60", *INSIDE), "Biopsy enters"),
        (("--target", "Tumor", "0", "-100", "95"), "Tumor is"),
    ],
)
def test_a_plan_that_cannot_be_carried_out_is_reported_and_nothing_is_written(
    tmp_path, capsys, words, sentence
):
    assert copied(tmp_path / "copy", *words) == 2
    assert sentence in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
