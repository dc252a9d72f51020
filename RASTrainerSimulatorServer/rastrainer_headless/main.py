"""Slicer's side without Slicer: receives, registers, scores and keeps trials, then writes files.

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
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError, RASTrainerError
from rastrainer.protocol import DEFAULT_HOST, DEFAULT_PORT
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.link.link_status import LinkStatus
from rastrainer.slicer.logic.procedure_logic import ProcedureLogic
from rastrainer.slicer.logic.scenario_cache import ScenarioCache
from rastrainer.slicer.logic.trial_delivery import AbortedTrialsLogic
from rastrainer.slicer.logic.trial_logic import TrialLogic
from rastrainer.slicer.scene.nodes import labelsOf, localPoints
from rastrainer.slicer.scene.scenario_nodes import VolumeLoader, showScenario
from rastrainer.study.database.study import STUDY_FILE, Study
from rastrainer.trial.analysis import TrialAnalysis
from rastrainer.trial.ctps import read_trials
from rastrainer_headless.connector import headlessKit
from rastrainer_headless.output import appendResults, results_json, writeOutput
from rastrainer_headless.scene import HeadlessScene

PERIOD_S = 0.005


class TrialsMissingError(RASTrainerError):
    """The trials did not come in time."""


class HeadlessHost:
    """Replaces Slicer's application: owns the scene and calls what is due.

    Attributes:
        application: the scene and what it needs.
        link: to the simulator.
        latest: the trial that was scored last.
        scored: how many trials were scored; their numbers are in the output folder, not here.
    """

    def __init__(self, cache: ScenarioCache, output: Path, cohort: Path | None) -> None:
        self.application = HeadlessScene()
        self.link = Link(self.application.scene, headlessKit, client="headless Slicer")
        self.latest: TrialAnalysis | None = None
        self.scored = 0
        self._output = output
        self._touches = 0
        self._work = BackgroundWork()
        self._images = VolumeLoader(self.application.scene, self._work)
        self._presenter = TrialLogic(
            self.application.scene,
            self.link,
            cache.find,
            lambda: _openStudy(output),
            self._work,
            () if cohort is None else read_trials(cohort),
        )
        self._aborted = AbortedTrialsLogic(self.link, lambda: _openStudy(output), self._work)
        self._aborted.kept.connect(
            lambda trial: printEvent("aborted", trialId=trial.trial_id, reason=trial.reason)
        )
        self._procedure = ProcedureLogic(self.application.scene, self.link, cache.find, self._work)
        self.link.statusChanged.connect(self._tellStatus)
        self.link.pointsChanged.connect(self._tellPoints)
        self._presenter.trialScored.connect(self._tellTrial)
        for problems in (
            self._presenter.problemFound,
            self._aborted.problemFound,
            self._images.problemFound,
            self._procedure.answered,
        ):
            problems.connect(lambda sentence: printEvent("problem", sentence=sentence))

    def run(self, count: int, timeoutS: float) -> TrialAnalysis:
        """Wait until a number of trials are scored, and return the last one.

        Raises:
            TrialsMissingError: they did not come in time.
            InputError: a trial's numbers cannot be written into the output folder.
        """
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
            self._images.process()
            self._work.process()
            time.sleep(PERIOD_S)
        return self.latest

    def close(self) -> None:
        """Disconnect and close the study."""
        self._procedure.close()
        self._presenter.close()
        self._aborted.close()
        self._work.close()
        self.link.disconnect()

    def _tellStatus(self, status: LinkStatus) -> None:
        printEvent(
            "status", state=status.state.value, sentence=status.sentence, remedy=status.remedy
        )

    def _tellPoints(self, node: Any) -> None:
        labels, positions = labelsOf(node), localPoints(node)
        for row in range(self._touches, len(labels)):
            printEvent(
                "point", label=labels[row], count=row + 1, positionMm=positions[row].tolist()
            )
        if len(labels) < self._touches:
            printEvent("removed", count=len(labels))
        self._touches = len(labels)

    def _tellTrial(self, analysis: TrialAnalysis) -> None:
        results = results_json(analysis)
        appendResults(self._output, results)
        self.latest = analysis
        self.scored += 1
        printEvent("trial", results=results)


def _openStudy(folder: Path) -> Study:
    return Study.open(folder / STUDY_FILE, make_folder=True)


def printEvent(event: str, **values: Any) -> None:
    """Write one line of JSON to standard output."""
    print(json.dumps({"event": event, **values}, allow_nan=False), flush=True)


def main(argv: Sequence[str] | None = None) -> int:
    """Run and return the exit status."""
    arguments = _parser().parse_args(argv)
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
    _openStudy(arguments.output).close()
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


def _parser() -> argparse.ArgumentParser:
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
    return parser


if __name__ == "__main__":
    sys.exit(main())
