"""Writing and listing scenarios, and their set-ups."""

import json

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.files.writing import write_json
from rastrainer.head.mesh import read_head_mesh
from rastrainer.head.trial_head import Perturbation
from rastrainer.head.volume import read_head_volume
from rastrainer.json_records import record_to_json
from rastrainer.scenario.library import list_scenarios
from rastrainer.scenario.scenario import OperatingTable, SkullKind, Stand, load_scenario
from rastrainer.scenario.setup import HeadPlace, SetUp, read_setup
from rastrainer.scenario.writer import (
    new_folder,
    write_scenario,
)
from Testing.domain.scenario.made_up_scenario import ball_head, ball_volume, made_up_scenario, png


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


@pytest.mark.parametrize(
    ("field", "value", "sentence"),
    [
        ("targets", [{"name": "x", "positionRas": [1, 2]}], r"targets\[0\].positionRas must be"),
        (
            "trajectory",
            {"name": "x", "entryRas": [1, 2, 3], "targetRas": [1, 2, 3]},
            "entryRas must be at least 1 mm from",
        ),
        ("skull", {"file": "../x.ply", "kind": "bone"}, "skull.file must be the path"),
        (
            "volume",
            {"file": "../volume.nrrd", "window": 100, "level": 50},
            "volume.file must be the path of a file inside the scenario's folder",
        ),
        ("volume", {"file": "v.nrrd", "window": 0, "level": 5}, "volume.window must be a number"),
    ],
)
def test_an_invalid_plan_or_skull_is_named(tmp_path, field, value, sentence):
    written(tmp_path / "ball")
    path = tmp_path / "ball" / "scenario.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), field: value}))
    with pytest.raises(InputError, match=sentence):
        load_scenario(tmp_path / "ball")


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


@pytest.mark.parametrize(
    "content", [b"", b"picture", png(5000, 1), png(1, 5000), png() + bytes(4_000_000)]
)
def test_an_unusable_picture_is_not_listed(tmp_path, content):
    written(tmp_path / "ball")
    (tmp_path / "ball" / "preview.png").write_bytes(content)
    (ball,) = list_scenarios([tmp_path])
    assert (ball.preview, ball.problem) == (None, "")


def test_a_setup_is_written_and_read_back(tmp_path):
    limits = Perturbation(1.0, 2.0, 3.0)
    setup = SetUp(
        HeadPlace((1.0, 2, 3), 4.5),
        limits,
        OperatingTable((5.0, 6), (700.0, 800, 9)),
        Stand(90.0),
        (10.0, -11),
    )
    write_json(tmp_path / "setup.json", record_to_json(setup, with_defaults=True))
    assert read_setup(tmp_path / "setup.json") == setup


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


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ({"chair": {}}, 'there is no "chair"; use head, perturbation'),
        ({"head": {"yawDeg": 999}}, "head.yawDeg must be a number"),
        ({"perturbation": {"tiltDeg": 90}}, "perturbation.tiltDeg must be a number"),
    ],
)
def test_an_invalid_setup_is_refused_with_a_message(tmp_path, content, sentence):
    (tmp_path / "setup.json").write_text(json.dumps(content))
    with pytest.raises(InputError, match=sentence):
        read_setup(tmp_path / "setup.json")


def test_a_head_below_the_table_is_refused():
    with pytest.raises(InputError, match="0 mm above the table"):
        SetUp().check_height(-220.0, np.zeros(3))
