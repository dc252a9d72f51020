import json

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.point_files import write_markups
from rastrainer.files.point_list import PointList
from rastrainer.scenario.points import LABELS
from rastrainer.scenario.scenario import load_scenario

POINTS = np.random.default_rng(4).uniform(-90, 90, (15, 3)).round(4)
CAMERA = {
    "positionMm": [480, -600, 440],
    "focalPointMm": [480, 0, 225],
    "viewUp": [0, 0, 2],
    "viewAngleDeg": 30,
}
SCENARIO = {
    "formatVersion": 1,
    "name": "sphere",
    "title": "A sphere",
    "head": "head.ply",
    "target": {"name": "Center", "positionRas": [1, -17, 2]},
    "headToWorld": [-1, 0, 0, 480, 0, -1, 0, -17, 0, 0, 1, 218, 0, 0, 0, 1],
    "perturbation": {"translationMm": 15, "yawDeg": 8, "tiltDeg": 3},
    "tasks": [
        {"name": "trial-run", "title": "Trial run", "file": "tasks/a.mrk.json", "complexity": 3.5},
        {
            "name": "task-1",
            "title": "Task 1",
            "file": "tasks/b.mrk.json",
            "complexity": 7,
            "shortestPathMm": 612.5,
        },
    ],
    "cameras": {"close-up": CAMERA, "far": {**CAMERA, "positionMm": [240, -2000, 1000]}},
    "table": {"centerMm": [300, 0], "sizeMm": [1300, 1000, 40]},
    "stand": {"diameterMm": 80},
    "provenance": {"source": "made up", "method": "by hand", "license": "none needed"},
}


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "sphere"
    (folder / "tasks").mkdir(parents=True)
    for name in ("a", "b"):
        write_markups(folder / "tasks" / f"{name}.mrk.json", PointList(LABELS, POINTS))
    write(folder, SCENARIO)
    return folder


def write(folder, content):
    (folder / "scenario.json").write_text(json.dumps(content), encoding="utf-8")


def changed(path, value):
    """The scenario with one field replaced, given by a path such as cameras.far.viewUp."""
    content = json.loads(json.dumps(SCENARIO))
    *parents, last = path.split(".")
    place = content
    for parent in parents:
        place = place[int(parent) if parent.isdigit() else parent]
    place[last] = value
    return content


def test_a_scenario_is_read_completely(folder):
    scenario = load_scenario(folder)
    assert (scenario.name, scenario.title, scenario.folder) == ("sphere", "A sphere", folder)
    assert scenario.head == (folder / "head.ply").resolve()
    assert scenario.target.name == "Center"
    assert scenario.target.position_ras.tolist() == [1, -17, 2]
    assert scenario.head_to_world[:3, 3].tolist() == [480, -17, 218]
    assert [task.name for task in scenario.tasks] == ["trial-run", "task-1"]
    assert scenario.task("task-1").complexity == 7.0
    assert [task.shortest_path_mm for task in scenario.tasks] == [None, 612.5]
    assert np.array_equal(scenario.task("trial-run").fiducials, POINTS)
    assert scenario.cameras["close-up"].view_up.tolist() == [0, 0, 1]
    assert scenario.cameras["far"].position_mm.tolist() == [240, -2000, 1000]
    assert scenario.stand.diameter_mm == 80
    assert scenario.provenance.license == "none needed"


def test_the_same_seed_gives_the_same_pose(folder):
    scenario = load_scenario(folder)
    first, again = (scenario.perturbed_head_to_world(7) for _ in range(2))
    assert np.array_equal(first, again)
    assert not np.allclose(first, scenario.perturbed_head_to_world(8), atol=0.01)


def test_perturbed_poses_fill_the_limits_and_stay_within_them(folder):
    scenario = load_scenario(folder)
    center = transforms.apply(scenario.head_to_world, scenario.target.position_ras)
    shifts, tilts, yaws = [], [], []
    for seed in range(200):
        pose = scenario.perturbed_head_to_world(seed)
        turn = pose[:3, :3] @ scenario.head_to_world[:3, :3].T
        assert np.allclose(turn @ turn.T, np.eye(3))
        assert np.linalg.det(turn) == pytest.approx(1)
        shifts.append(transforms.apply(pose, scenario.target.position_ras) - center)
        tilts.append(np.degrees(np.arccos(np.clip(turn[2, 2], -1, 1))))
        yaws.append(np.degrees(np.arctan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1])))
    for values, limit in ((shifts, 15), (tilts, 3), (yaws, 8)):
        assert np.abs(values).max() == pytest.approx(limit, rel=0.02)
        assert np.abs(values).max() <= limit * 1.001
    assert np.abs(np.mean(shifts, axis=0)).max() < 1.5


SKEWED = [-1, 0.1, 0, 480, 0, -1, 0, -17, 0, 0, 1, 218, 0, 0, 0, 1]
MIRRORED = [1, 0, 0, 480, 0, -1, 0, -17, 0, 0, 1, 218, 0, 0, 0, 1]


@pytest.mark.parametrize(
    ("path", "value", "sentence"),
    [
        ("formatVersion", 2, "formatVersion must be 1"),
        ("name", "Sphere!", "name must be lower-case letters"),
        ("head", "../head.ply", "head must be the path of a file inside"),
        ("head", "/etc/passwd", "head must be the path of a file inside"),
        ("headToWorld", SKEWED, "headToWorld must be a rigid transform"),
        ("headToWorld", MIRRORED, "headToWorld must be a rigid transform"),
        ("tasks.1.name", "trial-run", "tasks must be a list in which each name occurs once"),
        ("tasks.1.file", "../../b.mrk.json", r"tasks\[1\].file must be the path of a file inside"),
        ("tasks.1.file", "tasks/none.mrk.json", "none.mrk.json"),
        ("cameras.far.viewUp", [0, 0, 0], "cameras.far.viewUp must be a direction across"),
        ("skin", {"seed": 1}, "skin must be an object of shiftMm and indentationMm"),
    ],
)
def test_an_invalid_field_is_named_with_what_it_must_be(folder, path, value, sentence):
    write(folder, changed(path, value))
    with pytest.raises(InputError, match=sentence) as caught:
        load_scenario(folder)
    assert "\n" not in str(caught.value)


def test_a_link_out_of_the_folder_is_not_followed(folder, tmp_path):
    outside = tmp_path / "outside.mrk.json"
    write_markups(outside, PointList(LABELS, POINTS))
    (folder / "tasks" / "link.mrk.json").symlink_to(outside)
    write(folder, changed("tasks.1.file", "tasks/link.mrk.json"))
    with pytest.raises(InputError, match="inside the scenario's folder"):
        load_scenario(folder)


@pytest.mark.parametrize(
    "content", [b"{", b"\xff\xfe", bytes(2**20 + 1)], ids=["cut", "bytes", "size"]
)
def test_an_invalid_scenario_file_is_refused_in_one_sentence(folder, content):
    (folder / "scenario.json").write_bytes(content)
    with pytest.raises(InputError, match=r"scenario\.json") as caught:
        load_scenario(folder)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["none", "n" * 300])
def test_a_missing_folder_is_refused_with_a_message(tmp_path, name):
    with pytest.raises(InputError, match="scenario"):
        load_scenario(tmp_path / name)
