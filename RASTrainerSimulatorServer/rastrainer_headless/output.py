"""What the headless side leaves behind: a trial's numbers as JSON, the scene and a picture."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import TargetError
from rastrainer.scenario.scenario import Scenario
from rastrainer.slicer.scene.error_colors import magnification
from rastrainer.trial.analysis import PublishedScore, RevealedTruth, TrialAnalysis
from rastrainer.trial.ctps import CTPS_WARNING
from rastrainer_headless.residual_picture import writeResidualPicture
from rastrainer_headless.scene import HeadlessScene


def results_json(analysis: TrialAnalysis) -> dict[str, Any]:
    """Return the numbers of a trial as a JSON object; lengths in mm, times in s."""
    record = analysis.record
    return {
        "trial_id": record.trial_id,
        "trainee": record.trainee,
        "task": record.task,
        "mode": record.mode,
        "scenario": record.scenario,
        "completion_time_s": record.completion_time_s,
        "rejected_touches": record.rejected_touches,
        "undone_touches": record.undone_touches,
        "labels": list(record.labels),
        "fits": {
            kind: _fit_json(fit, analysis.target_errors[kind])
            for kind, fit in analysis.fits.items()
        },
        "target": {
            "name": analysis.target_name,
            "position_ras_mm": list(analysis.expected_tre.target_mm),
        },
        "truth": None
        if analysis.truth is None
        else _truth_json(analysis.truth, analysis.expected_tre),
        "score": None if analysis.score is None else analysis.score.to_json(),
        "procedure": None
        if analysis.procedure is None
        else {
            "score": analysis.procedure.score.to_json(),
            "trajectories": [each.to_json() for each in analysis.procedure.analysis.trajectories],
        },
        "feedback": list(analysis.feedback.sentences),
        "motion": dict(record.motion),
        "ctps": None if analysis.published_score is None else _ctps_json(analysis.published_score),
    }


def _fit_json(fit: Registration, error: TargetError) -> dict[str, Any]:
    return {
        "type": fit.kind,
        "fre_mm": fit.fre_mm,
        "matrix": fit.matrix.tolist(),
        "residuals_mm": fit.residuals_mm.tolist(),
        "expected_tre_mm": error.expected_mm,
        "tre_interval_mm": list(error.interval_mm),
        "confidence": error.confidence,
        "warnings": [warning.to_json() for warning in fit.warnings],
    }


def _truth_json(truth: RevealedTruth, expected: TargetError) -> dict[str, Any]:
    low, high = expected.interval_mm
    return {
        "head_to_world": truth.matrix.tolist(),
        "true_tre_mm": truth.true_tre_mm,
        "within_interval": low <= truth.true_tre_mm <= high,
    }


def _ctps_json(score: PublishedScore) -> dict[str, Any]:
    return {
        "published": score.published,
        "equation_3": score.equation_3,
        "mean_ct_s": score.reference.mean_ct_s,
        "best_rmse_mm": score.reference.best_rmse_mm,
        "warning": CTPS_WARNING,
    }


SCENE = "trial.mrb"
PICTURE = "residuals.png"
RESULTS = "results.jsonl"


def appendResults(folder: Path, results: Mapping[str, Any]) -> None:
    """Add a trial's `results_json` to the file of results, as one line that is on the disk then.

    Raises:
        InputError: the file cannot be written.
    """
    path = folder / RESULTS
    try:
        with path.open("a", encoding="utf-8", newline="\n") as file:
            file.write(json.dumps(results, allow_nan=False) + "\n")
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise InputError(f"The file {path} cannot be written: {error.strerror}.") from None


def writeOutput(
    folder: Path, application: HeadlessScene, scenario: Scenario, latest: TrialAnalysis
) -> dict[str, str]:
    """Write scene and picture of the latest trial; return the paths of all files.

    Raises:
        InputError: a file cannot be written.
    """
    files = {"scene": folder / SCENE, "picture": folder / PICTURE, "results": folder / RESULTS}
    application.save(files["scene"])
    _writePicture(files["picture"], scenario, latest)
    return {name: str(path) for name, path in files.items()}


def _writePicture(path: Path, scenario: Scenario, analysis: TrialAnalysis) -> None:
    task = scenario.task(analysis.record.task)
    expected = analysis.expected_tre
    low, high = expected.interval_mm
    # The recording program may not know where the head was.
    true = "" if analysis.truth is None else f", true TRE {analysis.truth.true_tre_mm:.2f} mm"
    title = (
        f"{task.title}: rigid registration of {len(task.labels)} touched points, "
        f"FRE {analysis.rigid.fre_mm:.2f} mm"
    )
    caption = [
        "Ball and number: fiducial in the MRI and its residual in mm. Arrow: towards where the "
        f"registration puts the touch, {magnification(analysis.rigid):g} times as long.",
        f"At the target ({scenario.target_name}): expected TRE {expected.expected_mm:.2f} mm "
        f"(95 %: {low:.2f} to {high:.2f} mm){true}. "
        "FRE does not predict TRE case by case.",
    ]
    head = read_head_mesh(scenario.head_mesh)
    writeResidualPicture(path, head, analysis.rigid, title, caption)
