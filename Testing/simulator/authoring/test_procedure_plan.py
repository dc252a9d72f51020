"""The procedures of the default head can be carried out; infeasible plans are reported."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.head.mesh import read_head_mesh, write_head_mesh
from rastrainer.procedure.plan import ProcedureKind, read_procedure_meshes
from rastrainer.scenario.library import checked_scenario
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.authoring.procedure_plan import (
    check_procedures,
    require_usable_procedures,
)
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.core.setup import load_setup

FOLDER = asset_path("scenarios", "colin27")
SCENARIO = load_scenario(FOLDER)
STN = np.array([12.58, -13.41, -5.87])


@pytest.fixture(scope="module")
def planning():
    return PlanningSetup(SCENARIO, read_head_mesh(SCENARIO.head))


@pytest.fixture
def copy(tmp_path):
    """A copy of the default scenario with its trial run and its DBS alone, without images."""
    folder = tmp_path / "copy"
    shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("volume.nrrd"))
    values = json.loads((folder / "scenario.json").read_text(encoding="utf-8"))
    del values["volume"]
    values["tasks"] = values["tasks"][:1]
    values["procedures"] = [each for each in values["procedures"] if each["name"] == "dbs"]
    return write(folder, values)


def write(folder, values):
    (folder / "scenario.json").write_text(json.dumps(values), encoding="utf-8")
    return folder


def with_line(folder, entry, target):
    values = json.loads((folder / "scenario.json").read_text(encoding="utf-8"))
    values["procedures"][0]["trajectories"][1].update(entryRas=entry, targetRas=target)
    return write(folder, values)


def test_the_default_head_has_one_feasible_procedure_of_each_kind(planning):
    assert [procedure.kind for procedure in SCENARIO.procedures] == list(ProcedureKind)
    assert [len(procedure.trajectories) for procedure in SCENARIO.procedures] == [1, 2, 5]
    assert check_procedures(planning) == []


def test_a_line_on_which_the_robot_cannot_hold_the_guide_is_named(copy):
    """The arm has no room on the right, between the robot's base and the head."""
    head = read_head_mesh(SCENARIO.head)
    near = np.abs(head.vertices[:, 1:] - STN[1:]).max(axis=1) < 3.0
    entry = head.vertices[near][head.vertices[near][:, 0].argmax()].round(2)
    with_line(copy, entry.tolist(), STN.tolist())
    assert check_procedures(PlanningSetup(load_scenario(copy), head)) == [
        "Deep brain stimulation of both subthalamic nuclei: the robot cannot hold the guide on the "
        "line of Right subthalamic nucleus where the head is; choose another entry, or move the "
        "head."
    ]
    with pytest.raises(InputError, match="cannot hold the guide on the line of Right subthalamic"):
        require_usable_procedures(load_setup(copy))


def test_a_target_outside_the_head_is_refused_when_packed_and_when_loaded(copy):
    with_line(copy, [41.35, 35.39, 70.05], [41.35, 35.39, 120.0])
    sentence = r"Right subthalamic nucleus has its target \d+ mm outside of the head\."
    with pytest.raises(InputError, match=sentence):
        checked_scenario(copy)
    with pytest.raises(InputError, match=sentence):
        require_usable_procedures(load_setup(copy))


@pytest.fixture
def own_procedure(copy, tmp_path):
    """A procedure in its own file, whose structure has the file name of another one."""
    folder = tmp_path / "plan"
    (folder / "no-go").mkdir(parents=True)
    values = json.loads((copy / "scenario.json").read_text(encoding="utf-8"))["procedures"][0]
    mesh = read_head_mesh(copy / values["noGo"][0]["file"])
    moved = replace(mesh, vertices=mesh.vertices + np.array([0.0, 0.0, 0.5]))
    write_head_mesh(folder / values["noGo"][0]["file"], moved)
    values.update(name="own", title="My own", noGo=values["noGo"][:1])
    path = folder / "procedure.json"
    path.write_text(json.dumps(values), encoding="utf-8")
    return path


def plan_arguments(copy, made, path):
    return ["scenario", "plan", str(copy), "-o", str(made), "--procedure", str(path)]


@pytest.mark.usefixtures("unrendered")
def test_a_procedure_from_a_file_is_added_with_its_meshes(copy, own_procedure, tmp_path):
    assert main(plan_arguments(copy, tmp_path / "made", own_procedure)) == 0
    made = load_scenario(tmp_path / "made")
    assert [each.name for each in made.procedures] == ["dbs", "own"]
    before = read_procedure_meshes(load_scenario(copy).procedure("dbs"), copy / "skull.ply")
    after = read_procedure_meshes(made.procedure("dbs"), made.skull.file)
    own = read_procedure_meshes(made.procedure("own"), made.skull.file)
    (name,) = own.no_go
    assert np.array_equal(after.no_go[name].vertices, before.no_go[name].vertices)
    shift = own.no_go[name].vertices - before.no_go[name].vertices
    assert shift == pytest.approx(np.tile([0.0, 0.0, 0.5], (len(shift), 1)), abs=1e-4)


def test_an_infeasible_procedure_is_not_saved(copy, own_procedure, tmp_path, capsys):
    values = json.loads(own_procedure.read_text(encoding="utf-8"))
    values["trajectories"][0]["targetRas"] = [0.0, 0.0, 150.0]
    own_procedure.write_text(json.dumps(values), encoding="utf-8")
    before = sorted(tmp_path.rglob("*"))
    assert main(plan_arguments(copy, tmp_path / "made", own_procedure)) == 2
    said = capsys.readouterr().err
    assert "Left subthalamic nucleus has its target" in said
    assert "outside of the head." in said
    assert main(["scenario", "lines", str(copy), "--procedure", str(own_procedure)]) == 1
    assert sorted(tmp_path.rglob("*")) == before


def test_the_planned_lines_are_measured_in_a_table_and_a_file(copy, tmp_path, capsys):
    path = tmp_path / "lines.json"
    assert main(["scenario", "lines", str(copy), "--json", str(path)]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert printed[1].startswith("line  ")
    assert printed[2].startswith("Left subthalamic nucleus")
    assert printed[2].endswith("yes")
    (measured,) = json.loads(path.read_text(encoding="utf-8"))
    assert [line["isHeld"] for line in measured["lines"]] == [True, True]
    assert measured["wrong"] == []
