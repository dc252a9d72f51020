"""Writing and listing scenarios, and their set-ups."""

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.head.volume import read_head_volume
from rastrainer.scenario.library import list_scenarios
from rastrainer.scenario.scenario import SkullKind, load_scenario
from rastrainer.scenario.setup import SetUp
from rastrainer.scenario.writer import new_folder, write_scenario
from Testing.domain.scenario.made_up_scenario import (
    ball_head,
    ball_volume,
    change_scenario,
    made_up_scenario,
    png,
)


def written(folder, skull=None, volume=None):
    with new_folder(folder) as made:
        write_scenario(made, made_up_scenario(), ball_head(), skull, volume)
    return load_scenario(folder)


def test_a_scenario_is_read_back_with_targets_and_trajectory(tmp_path):
    scenario = written(tmp_path / "ball", skull=ball_head(80.0))
    wanted = made_up_scenario()
    assert (scenario.name, scenario.title, scenario.target.name) == ("ball", "A ball", "Tumor")
    assert np.allclose(scenario.head_to_world, wanted.head_to_world)
    assert [task.complexity for task in scenario.tasks] == [10.0, 11.0]
    assert [task.shortest_path_mm for task in scenario.tasks] == [500.0, None]
    assert np.array_equal(scenario.tasks[1].fiducials, wanted.tasks[1].fiducials)
    assert scenario.targets[0].name == "Cyst"
    assert scenario.targets[0].position_ras.tolist() == [10, 20, 30]
    assert scenario.trajectory.entry_ras.tolist() == [0, 0, 90]
    assert scenario.provenance == wanted.provenance
    assert read_head_mesh(scenario.skull.file).vertices.max() == pytest.approx(80, abs=1e-3)
    assert scenario.skull.kind is SkullKind.BONE
    assert scenario.preview is None


def test_a_volume_is_read_back_and_optional(tmp_path):
    images = ball_volume()
    read = read_head_volume(written(tmp_path / "with", volume=images).volume)
    assert np.array_equal(read.values, images.values)
    assert np.array_equal(read.ijk_to_ras, images.ijk_to_ras)
    assert (read.window, read.level) == (images.window, images.level)
    assert written(tmp_path / "without").volume is None


def test_a_folder_that_is_not_empty_is_not_written_into(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match="already exists"), new_folder(tmp_path / "mine"):
        pass
    assert [path.name for path in tmp_path.rglob("*")] == ["mine", "notes.txt"]


def test_a_failure_leaves_no_folder_behind(tmp_path):
    def fail():
        with new_folder(tmp_path / "new") as made:
            (made / "half").write_text("half")
            raise InputError("no")

    with pytest.raises(InputError, match="no"):
        fail()
    assert not list(tmp_path.iterdir())


MIRRORED = [1, 0, 0, 480, 0, -1, 0, -17, 0, 0, 1, 218, 0, 0, 0, 1]


@pytest.mark.parametrize(
    ("path", "value", "sentence"),
    [
        ("formatVersion", 2, "formatVersion must be 1"),
        ("headToWorld", MIRRORED, "headToWorld must be a rigid transform"),
        ("tasks.1.name", "task-1", "tasks must be a list in which each name occurs once"),
        ("tasks.1.file", "../../b.mrk.json", r"tasks\[1\].file must be the path of a file inside"),
        ("tasks.1.file", "tasks/none.mrk.json", "none.mrk.json"),
        ("cameras.far.viewUp", [0, 0, 0], "cameras.far.viewUp must be a direction across"),
        ("skin", {"seed": 1}, "skin must be an object of shiftMm and indentationMm"),
        ("targets", [{"name": "x", "positionRas": [1, 2]}], r"targets\[0\].positionRas must be"),
        ("trajectory.targetRas", [0, 0, 90], "entryRas must be at least 1 mm from"),
        ("skull", {"file": "../x.ply", "kind": "bone"}, "skull.file must be the path"),
        ("volume", {"file": "v.nrrd", "window": 0, "level": 5}, "volume.window must be a number"),
    ],
)
def test_an_invalid_field_is_named_with_what_it_must_be(tmp_path, path, value, sentence):
    written(tmp_path / "ball")
    change_scenario(tmp_path / "ball", path, value)
    with pytest.raises(InputError, match=sentence) as caught:
        load_scenario(tmp_path / "ball")
    assert "\n" not in str(caught.value)


def test_perturbed_poses_are_seeded_fill_the_limits_and_stay_within_them(tmp_path):
    scenario = written(tmp_path / "ball")
    target, limits = scenario.target.position_ras, scenario.perturbation
    center = transforms.apply(scenario.head_to_world, target)
    shifts, tilts, yaws = [], [], []
    for seed in range(200):
        pose = scenario.perturbed_head_to_world(seed)
        assert np.array_equal(pose, scenario.perturbed_head_to_world(seed))
        turn = pose[:3, :3] @ scenario.head_to_world[:3, :3].T
        assert np.allclose(turn @ turn.T, np.eye(3))
        assert np.linalg.det(turn) == pytest.approx(1)
        shifts.append(transforms.apply(pose, target) - center)
        tilts.append(np.degrees(np.arccos(np.clip(turn[2, 2], -1, 1))))
        yaws.append(np.degrees(np.arctan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1])))
    allowed = (limits.translation_mm, limits.tilt_deg, limits.yaw_deg)
    for values, limit in zip((shifts, tilts, yaws), allowed, strict=True):
        assert np.abs(values).max() == pytest.approx(limit, rel=0.02)
        assert np.abs(values).max() <= limit * 1.001
    assert np.abs(np.mean(shifts, axis=0)).max() < 1.5


def test_scenarios_are_listed_by_title_with_picture_or_problem(tmp_path):
    written(tmp_path / "ball")
    (tmp_path / "ball" / "preview.png").write_bytes(png())
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "scenario.json").write_text("{")
    ball, broken = list_scenarios([tmp_path, tmp_path / "none"])
    assert (ball.name, ball.title, ball.problem) == ("ball", "A ball", "")
    assert ball.preview == tmp_path / "ball" / "preview.png"
    assert "scenario.json" in broken.problem
    assert broken.preview is None


def test_moving_the_robot_base_moves_everything_else_the_opposite_way():
    usual, moved = SetUp(), SetUp(robot_base_mm=(100.0, -50.0))
    shift = [-100, 50, 0]
    middle = np.zeros(3)
    assert np.allclose(
        moved.head_to_world(middle)[:3, 3] - usual.head_to_world(middle)[:3, 3], shift
    )
    for name, camera in moved.cameras().items():
        assert np.allclose(camera.position_mm - usual.cameras()[name].position_mm, shift)
    away = np.subtract(moved.table_in_world().center_mm, usual.table_in_world().center_mm)
    assert np.allclose(away, shift[:2])


def test_a_head_below_the_table_is_refused():
    with pytest.raises(InputError, match="0 mm above the table"):
        SetUp().check_height(-220.0, np.zeros(3))
