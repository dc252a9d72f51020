"""A whole simulated study: played, stored like a real one, with the truth beside it."""

from __future__ import annotations

import functools
import json
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from rastrainer.cohort.jobs import trial_jobs
from rastrainer.cohort.population import Population
from rastrainer.experiment.study_progress import StudyProgress
from rastrainer.experiment.study_protocol import StudyProtocol, protocol_text
from rastrainer.files import make_empty_folder, write_text
from rastrainer.study import Study
from rastrainer_simulator.cohort.engines import PROCESSES, run_jobs
from rastrainer_simulator.cohort.play import PlayedTrial, PlaySettings, play_job

DATABASE, TRUTH, PROTOCOL, RECORDS = "study.db", "truth.json", "protocol.json", "records"


@dataclass(frozen=True)
class CohortRun:
    """How a simulation went.

    Attributes:
        played: Trials that were finished and stored.
        stuck: Trials in which the virtual trainee did not get to a fiducial.
        seconds: Wall time of playing and storing.
        simulated_s: Trial time of all finished trials.
    """

    played: int
    stuck: int
    seconds: float
    simulated_s: float


def simulate_cohort(
    protocol: StudyProtocol,
    population: Population,
    trainees: int,
    seed: int,
    folder: Path,
    settings: PlaySettings,
    with_journals: bool = False,
    engine: str = PROCESSES,
    workers: int | None = None,
    address: str | None = None,
    on_trial: Callable[[int], None] | None = None,
) -> CohortRun:
    """Play the study of a protocol with virtual trainees and store it in an empty folder.

    Questionnaires, breaks and trial runs are left out: virtual trainees have no opinion and need no
    rest. The protocol that is stored says so.

    Raises:
        InputError: the folder holds something, a task is not in the scenario, or the engine fails.
    """
    make_empty_folder(folder)
    protocol = replace(
        protocol,
        title=f"{protocol.title[:90]} (virtual trainees)",
        trial_run_min=0.0,
        break_between_modes_min=0.0,
        break_between_tasks_min=0.0,
        asked=(),
    )
    began = time.perf_counter()
    records = folder / RECORDS if with_journals else None
    if records is not None:
        records.mkdir()
    settings = PlaySettings(settings.scenario, settings.step_s, protocol.references, records)
    jobs = trial_jobs(protocol, population, trainees, seed)
    function = functools.partial(play_job, settings=settings)
    played = stuck = 0
    simulated_s = 0.0
    with Study.open(folder / DATABASE) as study:
        StudyProgress(study).begin(protocol)
        for trial in run_jobs(function, jobs, engine, workers, address):
            if trial.analysis is None:
                stuck += 1
                continue
            _store(study, trial)
            played += 1
            simulated_s += trial.record.completion_time_s
            if on_trial is not None:
                on_trial(played + stuck)
    write_text(folder / PROTOCOL, protocol_text(protocol))
    truth = {"seed": seed, "trainees": trainees, "population": asdict(population)}
    write_text(folder / TRUTH, json.dumps(truth, indent=2) + "\n")
    return CohortRun(played, stuck, time.perf_counter() - began, simulated_s)


def _store(study: Study, trial: PlayedTrial) -> None:
    analysis, record = trial.analysis, trial.record
    if record.trainee not in {trainee.pseudonym for trainee in study.trainees()}:
        study.create_trainee(record.trainee, consent=True)
    study.add_trial(record, analysis.fits.values(), analysis.target_errors, analysis.score)
    study.set_truth(record.trial_id, trial.true_tre_mm, trial.head_to_world.ravel().tolist())
