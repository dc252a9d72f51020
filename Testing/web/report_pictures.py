"""Make the pictures of reports: python -m Testing.web.report_pictures [FOLDER].

That of the target errors is of a drawn study: eight trainees do all tasks on the built-in head in
both modes; in the headset the view misleads all touches by 1 mm. With the folder of the cohort that
`Testing.error_rates.cohort` has played, the sections that recover its truth are shown, too.
"""

from __future__ import annotations

import io
import sys
import tempfile
import uuid
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import Browser, Locator, Page, sync_playwright

from rastrainer import transforms
from rastrainer.json_records import record_from_json
from rastrainer.scenario.scenario import Scenario, Task, load_scenario
from rastrainer.study.database.study import Study
from rastrainer.study.study_data import read_study_data
from rastrainer.trial.analysis import RevealedTruth, analyze_trial
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.report.report import write_report
from rastrainer_simulator.virtual.cohort import DATABASE
from Testing.domain.trial.trial_records import make_record
from Testing.web.chromium import launch

ROOT = Path(__file__).parents[2]
PICTURE = ROOT / "Screenshots" / "report-target-errors.png"
COHORT_PICTURE = ROOT / "docs" / "pictures" / "report-of-a-cohort.png"
COHORT_SECTIONS = ("What completion time and error vary with", "Expected and true target error")
COLORS = 128
"""Size of the cohort's picture, for a small file."""
MARGIN = 24
TRAINEES, MODES = 8, ("desktop", "hmd")
SCATTER_MM = (0.4, 1.1)
"""Standard deviation of touches on each axis: the best trainee's and the worst's."""
VIEW_BIAS_MM = {"desktop": np.zeros(3), "hmd": np.array([0.9, 0.3, -0.4])}
SIZE = {"width": 900, "height": 800}


def draw_study(path: Path, seed: int = 4) -> None:
    """Fill a study with trials whose truth is known."""
    scenario = load_scenario(asset_path("scenarios", "colin27"))
    random = np.random.default_rng(seed)
    tasks = [task for task in scenario.tasks if task.name.startswith("task-")]
    with Study.open(path) as study:
        for number, scatter in enumerate(np.linspace(*SCATTER_MM, TRAINEES), start=1):
            name = f"T-{number:03d}"
            study.create_trainee(name, consent=True)
            for mode in MODES if number % 2 else MODES[::-1]:
                for task in tasks:
                    errors = random.normal(0, scatter, (15, 3)) + VIEW_BIAS_MM[mode]
                    _add_trial(study, scenario, task, (name, mode), errors, random)


def _add_trial(
    study: Study,
    scenario: Scenario,
    task: Task,
    who: tuple[str, str],
    errors_mm: np.ndarray,
    random: np.random.Generator,
) -> None:
    head_to_world = scenario.perturbed_head_to_world(int(random.integers(1_000_000)))
    touched = transforms.apply(head_to_world, task.fiducials + errors_mm)
    trial_id = str(uuid.UUID(int=int(random.integers(2**62))))
    (name, mode), time = who, 130.0 * float(np.exp(random.normal(0, 0.15)))
    record = make_record(
        trialId=trial_id, trainee=name, mode=mode, task=task.name, completionTimeS=time
    )
    for point, label, position in zip(record["points"], task.labels, touched, strict=True):
        point["label"], point["positionMm"] = label, position.tolist()
    analysis = analyze_trial(record_from_json(TrialRecord, record), scenario)
    study.add_trial(record, analysis.fits.values(), analysis.target_errors, analysis.score)
    target = scenario.target.position_ras[None]
    there = transforms.apply(analysis.rigid.matrix @ head_to_world, target)
    study.add_results(
        trial_id,
        truth=RevealedTruth(
            tuple(head_to_world.ravel().tolist()), float(np.linalg.norm(there - target))
        ),
    )


def main(cohort: str = "") -> None:
    """Make the pictures."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        path = Path(folder, "study.db")
        draw_study(path)
        browser = launch(playwright)
        page = _report(browser, path, Path(folder), scale=1.5)
        _section(page, "Expected and true target error").screenshot(path=PICTURE)
        if cohort:
            page = _report(browser, Path(cohort, DATABASE), Path(folder), scale=1.0)
            shown = [_section(page, title).screenshot() for title in COHORT_SECTIONS]
            picture = _stacked(shown).quantize(COLORS, Image.Quantize.MAXCOVERAGE)
            picture.save(COHORT_PICTURE, optimize=True)
        browser.close()


def _report(browser: Browser, study: Path, folder: Path, scale: float) -> Page:
    """Return the page of the report of a study."""
    written = write_report(read_study_data(study), folder / "report")
    page = browser.new_page(viewport=SIZE, device_scale_factor=scale)
    page.goto(written.as_uri())
    return page


def _section(page: Page, title: str) -> Locator:
    return page.locator("section", has=page.locator("h2", has_text=title))


def _stacked(pictures: Sequence[bytes]) -> Image.Image:
    """Return pictures of one width below each other, with a margin."""
    parts = [Image.open(io.BytesIO(picture)).convert("RGB") for picture in pictures]
    height = MARGIN + sum(part.height + MARGIN for part in parts)
    whole = Image.new("RGB", (parts[0].width + 2 * MARGIN, height), "white")
    top = MARGIN
    for part in parts:
        whole.paste(part, (MARGIN, top))
        top += part.height + MARGIN
    return whole


if __name__ == "__main__":
    main(*sys.argv[1:])
