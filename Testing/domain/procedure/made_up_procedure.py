"""A procedure on a spherical head with a spherical skull, for tests."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from rastrainer.head.mesh import HeadMesh
from rastrainer.procedure import plan
from rastrainer.scenario.writer import new_folder, write_scenario
from Testing.domain.scenario.made_up_scenario import ball_head, made_up_scenario

OUTER_MM, INNER_MM = 83.0, 76.0
VESSEL_MM = 5.0
VESSEL_CENTER = np.array([30.0, 0.0, 0.0])


def shell(outer=OUTER_MM, inner=INNER_MM):
    """A closed skull with an outer and an inner table."""
    outside, inside = ball_head(outer), ball_head(inner)
    triangles = [outside.triangles, inside.triangles[:, ::-1] + len(outside.vertices)]
    return HeadMesh(
        np.concatenate([outside.vertices, inside.vertices]),
        np.concatenate(triangles).astype(np.int32),
    )


def vessel(center=VESSEL_CENTER, radius=VESSEL_MM):
    ball = ball_head(radius)
    return HeadMesh(ball.vertices + center, ball.triangles)


def trajectory(
    name="Left", entry=(0.0, 0.0, 90.0), target=(0.0, 0.0, 20.0), diameter=2.0, safety=3.0
):
    return plan.ProcedureTrajectory(name, np.array(entry), np.array(target), diameter, safety)


def made_up_procedure(*trajectories, **changes):
    both = trajectories or (
        trajectory(),
        trajectory("Right", (-60.0, 0.0, 67.08), (-15.0, 10.0, 0.0)),
    )
    procedure = plan.Procedure(
        name="dbs-1",
        title="Two leads",
        kind=plan.ProcedureKind.DBS,
        source="made up",
        trajectories=both,
        no_go=(plan.NoGoStructure("Vessel", Path("no-go/vessel.ply")),),
        checkpoints=(plan.Checkpoint("Vertex", np.array([0.0, 0.0, 90.0])),),
    )
    return replace(procedure, **changes)


def made_up_meshes(**no_go):
    return plan.ProcedureMeshes(shell(), no_go or {"Vessel": vessel()})


def write_planned(folder, *procedures):
    """Write a scenario with procedures into a new folder."""
    scenario = replace(made_up_scenario(), procedures=procedures or (made_up_procedure(),))
    with new_folder(folder) as made:
        write_scenario(made, scenario, ball_head(), shell(), no_go={"vessel.ply": vessel()})
    return folder
