"""The files that the headless side leaves behind: scene, picture, numbers."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.head_mesh import read_head_mesh
from rastrainer.scenario import Scenario
from rastrainer.slicer.headless_scene import HeadlessScene
from rastrainer.slicer.residual_glyphs import magnification
from rastrainer.slicer.residual_picture import writeResidualPicture
from rastrainer.trial_analysis import TrialAnalysis

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
    title = (
        f"{task.title}: rigid registration of {len(task.labels)} touched points, "
        f"FRE {analysis.rigid.fre_mm:.2f} mm"
    )
    caption = [
        "Ball and number: fiducial in the MRI and its residual in mm. Arrow: towards where the "
        f"registration puts the touch, {magnification(analysis.rigid):g} times as long.",
        f"At the target ({scenario.target_name}): expected TRE {expected.expected_mm:.2f} mm "
        f"(95 %: {low:.2f} to {high:.2f} mm), true TRE {analysis.truth.true_tre_mm:.2f} mm. "
        "FRE does not predict TRE case by case.",
    ]
    head = read_head_mesh(scenario.head_mesh)
    writeResidualPicture(path, head, analysis.rigid, title, caption)
