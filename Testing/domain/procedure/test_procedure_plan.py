"""Procedures in a scenario's files are read as they were written, and errors are reported."""

import json
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.head.mesh import write_head_mesh
from rastrainer.procedure import plan
from rastrainer.scenario.library import pack, unpack
from rastrainer.scenario.scenario import load_scenario
from Testing.domain.procedure.made_up_procedure import (
    made_up_procedure,
    shell,
    vessel,
    write_planned,
)


@pytest.fixture
def folder(tmp_path):
    return write_planned(tmp_path / "planned")


def changed(folder, change):
    path = folder / "scenario.json"
    values = json.loads(path.read_text())
    change(values)
    path.write_text(json.dumps(values))
    return folder


def test_a_written_procedure_is_read_again(folder):
    scenario = load_scenario(folder)
    (procedure,) = scenario.procedures
    assert scenario.procedure("dbs-1") is procedure
    assert procedure.kind is plan.ProcedureKind.DBS
    assert plan.procedure_json(procedure) == plan.procedure_json(made_up_procedure())
    left = procedure.trajectories[0]
    assert left.length_mm == 70.0
    assert left.direction.tolist() == [0.0, 0.0, -1.0]
    assert not left.entry_ras.flags.writeable
    meshes = plan.read_procedure_meshes(procedure, scenario.skull.file)
    assert len(meshes.skull.triangles) == len(shell().triangles)
    assert np.allclose(meshes.no_go["Vessel"].vertices, vessel().vertices, atol=1e-4)


def test_a_package_keeps_the_procedures(folder, tmp_path):
    package = pack(folder, tmp_path / "planned.zip")
    unpacked = unpack(package, tmp_path / "library")
    before, after = load_scenario(folder), load_scenario(unpacked)
    assert plan.procedure_json(after.procedures[0]) == plan.procedure_json(before.procedures[0])
    assert (unpacked / "no-go/vessel.ply").read_bytes() == (
        folder / "no-go/vessel.ply"
    ).read_bytes()
    again = pack(unpacked, tmp_path / "again.zip")
    assert again.read_bytes() == package.read_bytes()


def set_in(*path_and_value):
    *path, value = path_and_value

    def change(values):
        inner = values["procedures"]
        for step in path[:-1]:
            inner = inner[step]
        inner[path[-1]] = value

    return change


def same_name(values):
    values["procedures"].append(dict(values["procedures"][0]))


def same_trajectory(values):
    lines = values["procedures"][0]["trajectories"]
    lines.append(dict(lines[0]))


def many_files(values):
    one = values["procedures"][0]
    values["procedures"] = [
        {
            **one,
            "name": f"p{row}",
            "noGo": [{"name": f"{n}", "file": f"no-go/s{row}-{n}.ply"} for n in range(8)],
        }
        for row in range(4)
    ]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda values: values.pop("skull"), "skull must be given, because .* needs a skull"),
        (many_files, "at most 30 files of no-go meshes"),
        (same_name, "procedures must be a list in which each name occurs once"),
        (same_trajectory, "trajectories must be a list in which each name occurs once"),
        (
            set_in(0, "trajectories", 0, "entryRas", [0.0, 0.0, 21.0]),
            "at least 10 mm from targetRas",
        ),
        (set_in(0, "noGo", 0, "file", "../vessel.ply"), "inside the scenario's folder"),
        (set_in(0, "noGo", 0, "file", "vessel.ply"), "must be no-go/NAME.ply"),
        (set_in(0, "noGo", 0, "file", "no-go/Vessel 1.ply"), "must be no-go/NAME.ply"),
    ],
)
def test_an_invalid_procedure_is_refused_in_one_sentence(folder, change, sentence):
    changed(folder, change)
    with pytest.raises(InputError, match=sentence) as caught:
        load_scenario(folder)
    assert str(folder / "scenario.json") in str(caught.value)


def hash_of(folder):
    scenario = load_scenario(folder)
    return scenario.procedures[0].sha256(scenario.skull.file)


def test_the_hash_of_a_procedure_covers_what_a_trial_depends_on(folder):
    before = hash_of(folder)
    changed(folder, set_in(0, "title", "Another title"))
    changed(folder, set_in(0, "source", "Another source"))
    assert hash_of(folder) == before
    write_head_mesh(folder / "no-go/vessel.ply", vessel(radius=6.0))
    with_vessel = hash_of(folder)
    write_head_mesh(folder / "skull.ply", shell(84.0))
    with_skull = hash_of(folder)
    changed(folder, set_in(0, "trajectories", 0, "targetRas", [0.0, 0.0, 21.0]))
    with_target = hash_of(folder)
    assert len({before, with_vessel, with_skull, with_target}) == 4


def tiled(mesh):
    copies = plan.MAX_NO_GO_TRIANGLES // len(mesh.triangles) + 1
    return replace(mesh, triangles=np.tile(mesh.triangles, (copies, 1)))


def opened(mesh):
    return replace(mesh, triangles=mesh.triangles[1:])


@pytest.mark.parametrize(
    ("name", "mesh", "sentence"),
    [
        ("no-go/vessel.ply", None, r"The mesh .*vessel.ply does not exist"),
        ("no-go/vessel.ply", opened(vessel()), r"no-go structure .*vessel.ply is not closed"),
        ("no-go/vessel.ply", tiled(vessel()), f"triangles; it may have {plan.MAX_NO_GO_TRIANGLES}"),
        ("skull.ply", opened(shell()), r"The skull .*skull.ply is not closed"),
    ],
    ids=["missing", "open", "huge", "open skull"],
)
def test_an_unusable_mesh_is_named(folder, name, mesh, sentence):
    (folder / name).unlink()
    if mesh is not None:
        write_head_mesh(folder / name, mesh)
    scenario = load_scenario(folder)
    with pytest.raises(InputError, match=sentence):
        plan.read_procedure_meshes(scenario.procedures[0], scenario.skull.file)
