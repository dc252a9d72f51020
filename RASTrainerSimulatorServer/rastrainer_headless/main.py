"""Slicer's side without Slicer: receives, registers, scores and stores trials, writes files.

    python -m rastrainer_headless.main --port 18944 --scenario DIR --output DIR [--trials N]

Every line on standard output is one JSON object with the key `event`:

    status  state, sentence, remedy              the link, whenever it changes
    point   label, count, positionMm             a touch has appeared in the scene
    removed count                                touches were undone, or a new trial started
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
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import slicer

from rastrainer.errors import InputError, RASTrainerError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.json_records import record_to_json
from rastrainer.protocol import DEFAULT_HOST, DEFAULT_PORT
from rastrainer.registration.fits import RIGID
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.logic.delivery_queue import AbortedTrialLogic
from rastrainer.slicer.logic.procedure_logic import ProcedureLogic
from rastrainer.slicer.logic.scenario_cache import ScenarioCache
from rastrainer.slicer.logic.trial_logic import TrialLogic
from rastrainer.slicer.logic.trial_services import TrialServices
from rastrainer.slicer.scene.error_colors import magnification
from rastrainer.slicer.scene.nodes import labelsOf
from rastrainer.slicer.scene.scenario_nodes import SceneFileLoader, showScenario
from rastrainer.study.database.study import STUDY_FILE, Study
from rastrainer.trial.analysis import TrialAnalysis
from rastrainer.trial.ctps import CTPS_WARNING, read_trials
from rastrainer.work_progress import allow_any_text
from rastrainer_headless.connector import headlessKit
from rastrainer_headless.residual_picture import writeResidualPicture
from rastrainer_headless.scene import HeadlessScene

PERIOD_S = 0.005
SCENE = "trial.mrb"
PICTURE = "residuals.png"
RESULTS = "results.jsonl"


class TrialsMissingError(RASTrainerError):
    """The trials did not come in time."""


class HeadlessHost:
    """Replaces Slicer's application: owns the scene and calls what is due."""

    def __init__(self, cache: ScenarioCache, output: Path, cohort: Path | None) -> None:
        self.application = HeadlessScene()
        self.link = Link(self.application.scene, headlessKit, client="headless Slicer")
        self.latest: TrialAnalysis | None = None
        self.scored = 0
        self._output = output
        self._touches = 0
        self._work = BackgroundWork()
        self._files = SceneFileLoader(self.application.scene, self._work)
        services = TrialServices(
            self.application.scene,
            self.link,
            cache.find,
            lambda: Study.open(output / STUDY_FILE, make_folder=True),
            self._work,
        )
        self._presenter = TrialLogic(services, () if cohort is None else read_trials(cohort))
        self._aborted = AbortedTrialLogic(services)
        self._procedure = ProcedureLogic(services)
        self._aborted.kept.connect(
            lambda trial: printEvent("aborted", trialId=trial.trial_id, reason=trial.reason)
        )
        self.link.statusChanged.connect(lambda status: printEvent("status", **asdict(status)))
        self.link.pointsChanged.connect(self._printPoints)
        self._presenter.trialScored.connect(self._printTrial)
        for problems in (
            self._presenter.problemFound,
            self._aborted.problemFound,
            self._files.problemFound,
            self._procedure.answered,
        ):
            problems.connect(lambda sentence: printEvent("problem", sentence=sentence))

    def run(self, count: int, timeoutS: float) -> TrialAnalysis:
        """Wait until a number of trials are scored, and return the last one."""
        end = time.monotonic() + timeoutS
        while self.scored < count or self.latest is None:
            if time.monotonic() > end:
                raise TrialsMissingError(
                    f"{self.scored} of {count} trials came within {timeoutS:g} s. "
                    f"{self.link.status.sentence} {self.link.status.remedy}".rstrip()
                )
            if self.link.connector is not None:
                self.link.connector.PeriodicProcess()
            self.link.process()
            self._files.process()
            self._work.process()
            time.sleep(PERIOD_S)
        return self.latest

    def close(self) -> None:
        self._procedure.close()
        self._presenter.close()
        self._aborted.close()
        self._work.close()
        self.link.disconnect()

    def _printPoints(self, node: Any) -> None:
        labels, positions = labelsOf(node), slicer.util.arrayFromMarkupsControlPoints(node)
        for row in range(self._touches, len(labels)):
            printEvent(
                "point", label=labels[row], count=row + 1, positionMm=positions[row].tolist()
            )
        if len(labels) < self._touches:
            printEvent("removed", count=len(labels))
        self._touches = len(labels)

    def _printTrial(self, analysis: TrialAnalysis) -> None:
        results = results_json(analysis)
        path = self._output / RESULTS
        try:
            with path.open("a", encoding="utf-8", newline="\n") as file:
                file.write(json.dumps(results, allow_nan=False) + "\n")
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise InputError(f"The file {path} cannot be written: {error.strerror}.") from None
        self.latest = analysis
        self.scored += 1
        printEvent("trial", results=results)


def printEvent(event: str, **values: Any) -> None:
    print(json.dumps({"event": event, **values}, allow_nan=False), flush=True)


def results_json(analysis: TrialAnalysis) -> dict[str, Any]:
    score, procedure, published = analysis.score, analysis.procedure, analysis.published_score
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
    return {
        "record": record_to_json(analysis.record, with_defaults=True),
        "fits": fits,
        "targetName": analysis.target_name,
        "truth": None if analysis.truth is None else record_to_json(analysis.truth),
        "score": None if score is None else record_to_json(score, with_defaults=True),
        "procedure": None
        if procedure is None
        else {
            "score": record_to_json(procedure.score, with_defaults=True),
            "trajectories": record_to_json(procedure.analysis)["trajectories"],
        },
        "feedback": list(analysis.feedback.sentences),
        "ctps": None
        if published is None
        else {**record_to_json(published), "warning": CTPS_WARNING},
    }


def writeOutput(
    folder: Path, application: HeadlessScene, scenario: Scenario, latest: TrialAnalysis
) -> dict[str, str]:
    """Write scene and picture of the latest trial; return the paths of all files."""
    files = {"scene": folder / SCENE, "picture": folder / PICTURE, "results": folder / RESULTS}
    application.save(files["scene"])
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
    head = read_head_mesh(scenario.head)
    writeResidualPicture(files["picture"], head, rigid, title, caption)
    return {name: str(path) for name, path in files.items()}


def main(argv: Sequence[str] | None = None) -> int:
    allow_any_text()
    parser = argparse.ArgumentParser(
        prog="python -m rastrainer_headless.main",
        description="Slicer's side without Slicer. Not for clinical use.",
    )
    parser.add_argument("--host", default=DEFAULT_HOST, help="where the simulator runs")
    parser.add_argument("--port", type=int, default=DEFAULT_PORT, help="its OpenIGTLink port")
    parser.add_argument(
        "--listen", action="store_true", help="wait for a simulator started with --connect"
    )
    parser.add_argument("--scenario", type=Path, required=True, metavar="DIR")
    parser.add_argument("--output", type=Path, required=True, metavar="DIR")
    parser.add_argument("--trials", type=int, default=1, metavar="N", help="trials to wait for")
    parser.add_argument("--timeout", type=float, default=600.0, metavar="S", help="seconds to wait")
    parser.add_argument("--cohort", type=Path, metavar="CSV", help="trials that CTPS compares with")
    arguments = parser.parse_args(argv)
    try:
        _run(arguments)
    except TrialsMissingError as error:
        print(f"rastrainer: {error}", file=sys.stderr)
        return 1
    except InputError as error:
        print(f"rastrainer: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def _run(arguments: argparse.Namespace) -> None:
    if arguments.trials < 1:
        raise InputError("Wait for at least one trial.")
    if not 0 < arguments.timeout < math.inf:
        raise InputError("The timeout must be a number of seconds above 0.")
    cache = ScenarioCache(arguments.scenario)
    scenario = load_scenario(arguments.scenario)
    # What is wrong with it is reported before anyone plays.
    Study.open(arguments.output / STUDY_FILE, make_folder=True).close()
    host = HeadlessHost(cache, arguments.output, arguments.cohort)
    showScenario(host.application.scene, scenario)
    try:
        if arguments.listen:
            host.link.listenOn(arguments.port)
        else:
            host.link.connectTo(arguments.host, arguments.port)
        latest = host.run(arguments.trials, arguments.timeout)
    finally:
        host.close()
    files = writeOutput(arguments.output, host.application, scenario, latest)
    printEvent("output", **files, study=str(arguments.output / STUDY_FILE))


if __name__ == "__main__":
    sys.exit(main())
