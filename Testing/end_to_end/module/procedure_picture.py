"""Save the picture of a procedure: `python -m Testing.end_to_end.module.procedure_picture PNG`."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.procedure.errors import analyze_procedure
from rastrainer.procedure.plan import read_procedure_meshes
from rastrainer.procedure.record import ProcedureRecord, UsedRegistration
from rastrainer.registration.registration import register
from rastrainer.scenario.scenario import load_scenario
from rastrainer.sections.views import SliceFollower
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.procedure_outcome import (
    ProcedureMeasures,
    ProcedureOutcome,
    reference_duration_s,
    score_procedure,
)
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.virtual.virtual_procedure import ProcedureHands, VirtualProcedure
from Testing.end_to_end.module.screenshots import take, temporary_host

PROCEDURE, TASK, TOUCHING_S, FLE_MM = "seeg", "task-3", 90.0, 2.0
SECTION = "procedureCollapsibleButton"


def carried_out() -> tuple[ProcedureOutcome, ProcedureRecord, RevealedTruth]:
    """Return what virtual hands made of stereo-EEG after a careless registration."""
    scenario = load_scenario(asset_path("scenarios", "colin27"))
    procedure, skull = scenario.procedure(PROCEDURE), scenario.skull.file
    assert skull is not None
    random, truth = np.random.default_rng(21), scenario.perturbed_head_to_world(21)
    fiducials = np.asarray(scenario.task(TASK).fiducials)
    touches = transforms.apply(truth, fiducials)
    touches += random.normal(0.0, FLE_MM / np.sqrt(3), touches.shape)
    fit = register(touches, fiducials)
    used = UsedRegistration(tuple(map(float, fit.matrix.ravel())), fit.fre_mm, 0.6)
    meshes = read_procedure_meshes(procedure, skull)
    hands = replace(ProcedureHands(), angle_sd_deg=0.8, depth_sd_mm=1.0)
    sha256 = procedure.sha256(skull)
    done = VirtualProcedure(
        procedure, meshes.skull, sha256, truth, used, TOUCHING_S, hands, random
    ).carried_out()
    analysis = analyze_procedure(done, procedure, meshes, truth)
    reference = reference_duration_s(TOUCHING_S, procedure)
    score = score_procedure(ProcedureMeasures.of(analysis, procedure), reference)
    return (
        ProcedureOutcome(analysis, score),
        done,
        RevealedTruth(tuple(truth.ravel().tolist()), 0.0),
    )


def save(picture: Path) -> None:
    """Show the outcome in the module, with the slices along the first instrument."""
    carried = carried_out()
    with temporary_host() as (host, _folder):
        host.open()
        host.press("showScenarioButton")
        host.finish_work()
        procedure = host.widget.logic.session.procedure
        procedure.showOutcome(*carried)
        guide, tip = procedure.lines[0].placed
        pose = np.eye(4)
        pose[:3, 2], pose[:3, 3] = (tip - guide) / np.linalg.norm(tip - guide), tip
        # The session's own follower restores the views in its next turn: nothing is guided now.
        session = host.widget.logic.session
        SliceFollower(host.scene, session.training, session.settings)._alignViews(pose)
        host.scene.GetFirstNodeByName("Head").SetDisplayVisibility(False)
        for name in ("scenario", "simulator", "setup"):
            host.find(f"{name}CollapsibleButton").collapsed = True
        host.find(SECTION).collapsed = False
        host.look_from(120.0, 20.0, 1.2)
        host.idle_for(1.0)
        take(host, picture)


if __name__ == "__main__":
    save(Path(sys.argv[1]))
