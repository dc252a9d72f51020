"""Slicer's side without Slicer: receives, registers, scores and stores trials, writes files.

    python -m rastrainer_headless.main --port 18944 --assets DIR --output DIR [--trials N]

Every line on standard output is one JSON object with the key `event`:

    status  state, sentence, remedy              the link, whenever it changes
    trial   results                              a trial is registered, scored and kept; the same
                                                 object is a line of results.jsonl
    problem sentence                             something is wrong with a trial or the images
    output  scene, picture, results, study       paths of the files, at the end

Exit status: 0 when all trials are kept, 1 when they did not come in time, 2 for bad arguments.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.json_records import record_to_json
from rastrainer.protocol import DEFAULT_PORT
from rastrainer.registration.fits import RIGID
from rastrainer.scenario.scenario import Scenario
from rastrainer.sections.module_session import ModulePaths, ModuleSession
from rastrainer.slicer.program.child_process import runHere
from rastrainer.slicer.program.simulator_package import SimulatorPackage
from rastrainer.slicer.scene.error_colors import magnification
from rastrainer.slicer.scene.scenario_nodes import showScenario
from rastrainer.study.database.database import PostgresAddress
from rastrainer.study.database.study import STUDY_FILE
from rastrainer.trial.analysis import TrialAnalysis
from rastrainer.trial.ctps import CTPS_WARNING
from rastrainer.work_progress import allow_any_text
from rastrainer_headless.connector import headlessKit
from rastrainer_headless.scene import HeadlessScene

PERIOD_S = 0.01
SCENARIO = "colin27"
SCENE = "trial.mrb"
PICTURE = "residuals.png"
RESULTS = "results.jsonl"


def openSession(
    scene: HeadlessScene, folder: Path, assets: Path, studyAddress: PostgresAddress | None = None
) -> ModuleSession:
    """Return the session of Slicer's module, on stand-ins for its scene and connector."""
    places = ModulePaths(
        assets=assets,
        python=Path(sys.executable),
        simulator=folder / "simulator",
        study=folder / STUDY_FILE,
        records=folder / "records",
        library=folder / "scenarios",
        package=SimulatorPackage(folder),
        studyAddress=studyAddress,
    )
    return ModuleSession(scene.scene, places, headlessKit, run=runHere)


def process(session: ModuleSession) -> None:
    """Do what Slicer's timers do; to be called every few milliseconds."""
    if session.link.connector is not None:
        session.link.connector.PeriodicProcess()
    session.process()


class TrialPrinter:
    """Prints what happens in a session, and writes a line on each scored trial."""

    def __init__(self, session: ModuleSession, results: Path) -> None:
        self.latest: TrialAnalysis | None = None
        self.scored = 0
        self._results = results
        session.link.statusChanged.connect(lambda status: printEvent("status", **asdict(status)))
        session.trials.trialScored.connect(self._printTrial)
        trials, files, procedure = session.trials, session.files, session.procedure
        for problems in (trials.problemFound, files.problemFound, procedure.answered):
            problems.connect(lambda sentence: printEvent("problem", sentence=sentence))

    def _printTrial(self, analysis: TrialAnalysis) -> None:
        results = results_json(analysis)
        with self._results.open("a", encoding="utf-8", newline="\n") as file:
            file.write(json.dumps(results, allow_nan=False) + "\n")
        self.latest = analysis
        self.scored += 1
        printEvent("trial", results=results)


def printEvent(event: str, **values: Any) -> None:
    print(json.dumps({"event": event, **values}, allow_nan=False), flush=True)


def results_json(analysis: TrialAnalysis) -> dict[str, Any]:
    whole = partial(record_to_json, with_defaults=True)
    fits = {}
    for kind, fit in analysis.fits.items():
        error = analysis.target_errors[kind]
        fits[kind] = {
            "freMm": fit.fre_mm,
            "matrix": fit.matrix.ravel().tolist(),
            "residualsMm": fit.residuals_mm.tolist(),
            "targetRas": list(error.target_mm),
            "expectedTreMm": error.expected_mm,
            "treIntervalMm": list(error.interval_mm),
            "warnings": [record_to_json(warning) for warning in fit.warnings],
        }
    procedure, published = analysis.procedure, analysis.published_score
    return {
        "record": whole(analysis.record),
        "fits": fits,
        "targetName": analysis.target_name,
        "feedback": list(analysis.feedback.sentences),
        "truth": analysis.truth and record_to_json(analysis.truth),
        "score": analysis.score and whole(analysis.score),
        "procedure": procedure
        and {
            "score": whole(procedure.score),
            "trajectories": record_to_json(procedure.analysis)["trajectories"],
        },
        "ctps": published and {**record_to_json(published), "warning": CTPS_WARNING},
    }


def writeOutput(
    folder: Path, scene: HeadlessScene, scenario: Scenario, latest: TrialAnalysis
) -> dict[str, str]:
    files = {"scene": folder / SCENE, "picture": folder / PICTURE, "results": folder / RESULTS}
    scene.save(files["scene"])
    task, rigid = scenario.task(latest.record.task), latest.rigid
    expected = latest.target_errors[RIGID]
    low, high = expected.interval_mm
    # The recording program may not know where the head was.
    true = "" if latest.truth is None else f", true TRE {latest.truth.true_tre_mm:.2f} mm"
    title = (
        f"{task.title}: rigid registration of {len(task.labels)} touched points, "
        f"FRE {rigid.fre_mm:.2f} mm"
    )
    caption = [
        "Ball and number: fiducial in the MRI and its residual in mm. Arrow: toward where the "
        f"registration puts the touch, {magnification(rigid):g} times as long.",
        f"At the target ({scenario.target.name}): expected TRE {expected.expected_mm:.2f} mm "
        f"(95 %: {low:.2f} to {high:.2f} mm){true}. "
        "FRE does not predict TRE case by case.",
    ]
    # Only here: matplotlib takes time to import.
    from rastrainer_headless.residual_picture import writeResidualPicture

    writeResidualPicture(files["picture"], read_head_mesh(scenario.head), rigid, title, caption)
    return {name: str(path) for name, path in files.items()}


def main(argv: Sequence[str] | None = None) -> int:
    allow_any_text()
    parser = argparse.ArgumentParser(
        prog="python -m rastrainer_headless.main",
        description="Slicer's side without Slicer. Not for clinical use.",
    )
    add = parser.add_argument
    add("--port", type=int, default=DEFAULT_PORT, help="the simulator's OpenIGTLink port")
    add("--output", type=Path, required=True, metavar="DIR")
    add("--trials", type=int, default=1, metavar="N", help="trials to wait for")
    add("--timeout", type=float, default=600.0, metavar="S", help="seconds to wait")
    add("--assets", type=Path, required=True, metavar="DIR", help="scenarios, robots and studies")
    arguments = parser.parse_args(argv)
    try:
        missing = _run(arguments)
    except InputError as error:
        print(f"rastrainer: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    if missing:
        print(f"rastrainer: {missing}", file=sys.stderr)
    return 1 if missing else 0


def _run(arguments: argparse.Namespace) -> str:
    """Write all files, or return in a sentence how many trials have not come in time."""
    if arguments.trials < 1:
        raise InputError("Wait for at least one trial.")
    if not 0 < arguments.timeout < math.inf:
        raise InputError("The timeout must be a number of seconds above 0.")
    output, scene = arguments.output, HeadlessScene()
    session = openSession(scene, output, arguments.assets)
    try:
        # Problems are reported before anyone plays.
        scenario = session.scenarios.find(SCENARIO)
        session.openStudyPatiently().close()
        printer = TrialPrinter(session, output / RESULTS)
        showScenario(scene.scene, scenario)
        session.link.connectTo(port=arguments.port)
        end = time.monotonic() + arguments.timeout
        while printer.scored < arguments.trials:
            if time.monotonic() > end:
                status = session.link.status
                return (
                    f"{printer.scored} of {arguments.trials} trials came within "
                    f"{arguments.timeout:g} s. {status.sentence} {status.remedy}".rstrip()
                )
            process(session)
            time.sleep(PERIOD_S)
    finally:
        session.close()
    assert printer.latest is not None
    files = writeOutput(output, scene, scenario, printer.latest)
    printEvent("output", **files, study=str(output / STUDY_FILE))
    return ""


if __name__ == "__main__":
    sys.exit(main())
