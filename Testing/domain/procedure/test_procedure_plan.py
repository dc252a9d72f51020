"""Procedures in a scenario's files are read as they were written, and errors are reported."""

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
from Testing.domain.scenario.made_up_scenario import change_scenario


@pytest.fixture
def folder(tmp_path):
    return write_planned(tmp_path / "planned")


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


ONE = plan.procedure_json(made_up_procedure())
MANY_FILES = [
    {
        **ONE,
        "name": f"p{row}",
        "noGo": [{"name": f"{n}", "file": f"no-go/s{row}-{n}.ply"} for n in range(8)],
    }
    for row in range(4)
]


@pytest.mark.parametrize(
    ("path", "value", "sentence"),
    [
        ("skull", None, "skull must be"),
        ("procedures", MANY_FILES, "at most 30 files of no-go meshes"),
        ("procedures", [ONE, ONE], "procedures must be a list in which each name occurs once"),
        ("procedures.0.trajectories.0.entryRas", [0.0, 0.0, 21.0], "at least 10 mm from targetRas"),
        ("procedures.0.noGo.0.file", "../vessel.ply", "inside the scenario's folder"),
        ("procedures.0.noGo.0.file", "vessel.ply", "must be no-go/NAME.ply"),
    ],
    ids=["no skull", "files", "names", "short", "path", "name"],
)
def test_an_invalid_procedure_is_refused_in_one_sentence(folder, path, value, sentence):
    change_scenario(folder, path, value)
    with pytest.raises(InputError, match=sentence) as caught:
        load_scenario(folder)
    assert str(folder / "scenario.json") in str(caught.value)


def hash_of(folder):
    scenario = load_scenario(folder)
    return scenario.procedures[0].sha256(scenario.skull.file)


def test_the_hash_of_a_procedure_covers_what_a_trial_depends_on(folder):
    before = hash_of(folder)
    change_scenario(folder, "procedures.0.title", "Another title")
    change_scenario(folder, "procedures.0.source", "Another source")
    assert hash_of(folder) == before
    write_head_mesh(folder / "no-go/vessel.ply", vessel(radius=6.0))
    with_vessel = hash_of(folder)
    write_head_mesh(folder / "skull.ply", shell(84.0))
    with_skull = hash_of(folder)
    change_scenario(folder, "procedures.0.trajectories.0.targetRas", [0.0, 0.0, 21.0])
    with_target = hash_of(folder)
    assert len({before, with_vessel, with_skull, with_target}) == 4
