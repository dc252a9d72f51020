"""The files that the headless side leaves behind: scene, picture, numbers."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from rastrainer.files import write_text
from rastrainer.head_mesh import read_head_mesh
from rastrainer.scenario import Scenario
from rastrainer.slicer.headless_scene import HeadlessScene
from rastrainer.slicer.residual_glyphs import magnification
from rastrainer.slicer.residual_picture import writeResidualPicture
from rastrainer.slicer.trial_desk import ScoredTrial

SCENE = "trial.mrb"
PICTURE = "residuals.png"
RESULTS = "results.json"


def writeOutput(
    folder: Path,
    application: HeadlessScene,
    scenario: Scenario,
    latest: ScoredTrial,
    results: Sequence[str],
) -> dict[str, str]:
    """Write scene and picture of the latest trial and the numbers of all; return the files' paths.

    `results` is each trial's `results_json` as text.

    Raises:
        InputError: a file cannot be written.
    """
    files = {"scene": folder / SCENE, "picture": folder / PICTURE, "results": folder / RESULTS}
    values = [json.loads(text) for text in results]
    write_text(files["results"], json.dumps({"trials": values}, indent=2, allow_nan=False) + "\n")
    application.save(files["scene"])
    _writePicture(files["picture"], scenario, latest)
    return {name: str(path) for name, path in files.items()}


def _writePicture(path: Path, scenario: Scenario, trial: ScoredTrial) -> None:
    analysis = trial.analysis
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
        f"(95 %: {low:.2f} to {high:.2f} mm), true TRE {trial.truth.true_tre_mm:.2f} mm. "
        "FRE does not predict TRE case by case.",
    ]
    head = read_head_mesh(scenario.head_mesh)
    writeResidualPicture(path, head, analysis.rigid, title, caption)
