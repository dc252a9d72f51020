"""A whole simulated study: played, and stored like a real study, with the truth in a file.

After an interruption (Ctrl-C, a full disk, a power failure) the same call resumes the study: its
jobs follow from the seed, and only those without a stored trial are played.
"""

from __future__ import annotations

import functools
import json
import os
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TypeVar

import rastrainer
from rastrainer.errors import InputError
from rastrainer.files.writing import make_empty_folder, write_text
from rastrainer.scenario.scenario import load_scenario
from rastrainer.study.database.cohort_store import CohortStore
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol, protocol_text
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.core.setup import DEFAULT_SCENARIO, scenario_sha256
from rastrainer_simulator.virtual.play import PlaySettings, play_job
from rastrainer_simulator.virtual.population import Population, trial_jobs
from rastrainer_simulator.virtual.worker_pool import (
    ATTEMPTS,
    WorkerDiedError,
    died_message,
    run_on_workers,
)

Job = TypeVar("Job")
Result = TypeVar("Result")

PROCESSES, DASK = "processes", "dask"
_AS_MANY_ATTEMPTS = {"distributed.scheduler.allowed-failures": ATTEMPTS - 1}


def run_jobs(
    function: Callable[[Job], Result],
    jobs: Iterable[Job],
    engine: str = PROCESSES,
    workers: int | None = None,
    address: str | None = None,
    name_of: Callable[[Job], str] = str,
) -> Iterator[Result]:
    """Yield the result of each job, in their order.

    A job whose process is killed is repeated by another one, unless `workers` is 1 and it is this
    process. `engine` is `processes`, or `dask` (package `distributed`); `address` names a Dask
    scheduler, for more than one machine; a local cluster by default.
    """
    workers = workers or os.cpu_count() or 1
    if engine == DASK:
        yield from _on_dask(function, jobs, workers, address, name_of)
    elif workers == 1:
        yield from map(function, jobs)
    else:
        yield from run_on_workers(function, jobs, workers, name_of)


def _on_dask(
    function: Callable[[Job], Result],
    jobs: Iterable[Job],
    workers: int,
    address: str | None,
    name_of: Callable[[Job], str],
) -> Iterator[Result]:
    try:
        import dask
        from distributed import Client, KilledWorker
    except ImportError:
        raise InputError(
            "The engine dask needs the package distributed: pip install distributed."
        ) from None
    try:
        if address is None:
            with dask.config.set(_AS_MANY_ATTEMPTS):
                client = Client(n_workers=workers, threads_per_worker=1, dashboard_address=None)
        else:
            client = Client(address, timeout="3s")
    except OSError as error:
        raise InputError(f"There is no Dask scheduler at {address}: {error}.") from None
    jobs = list(jobs)
    with client:
        for job, future in zip(jobs, client.map(function, jobs, pure=False), strict=True):
            try:
                yield future.result()
            except KilledWorker:
                # Dask blames every job of the worker, even if it had just finished.
                cause = " or another trial at the same worker"
                raise WorkerDiedError(died_message(name_of(job), cause)) from None


DATABASE, TRUTH, PROTOCOL, RECORDS = "study.db", "truth.json", "protocol.json", "records"


@dataclass(frozen=True)
class CohortRun:
    """How many trials were found played, were played now, or got stuck, and how long it took."""

    found: int
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
    on_trial: Callable[[int], None] = lambda _count: None,
) -> CohortRun:
    """Play the study of a protocol with virtual trainees and store it in a folder.

    The folder is empty, or holds such a study of equal arguments that was interrupted: then only
    the missing trials are played, with the same result. Questionnaires, breaks and trial runs are
    left out, also in the stored protocol: virtual trainees have no opinion and need no rest.
    `on_trial` is called with the number of finished trials.
    """
    protocol = _virtual(protocol, with_journals)
    if not (folder / DATABASE).is_file():
        make_empty_folder(folder)
    start = time.perf_counter()
    records = folder / RECORDS if with_journals else None
    played_with = PlaySettings(settings.scenario, settings.step_s, protocol.references, records)
    function = functools.partial(play_job, settings=played_with)
    truth = {"seed": seed, "trainees": trainees, "population": asdict(population)}
    scenario = load_scenario(settings.scenario or asset_path(*DEFAULT_SCENARIO))
    plan = {
        **truth,
        "step": settings.step_s,
        "scenario": scenario_sha256(scenario),
        "records": with_journals,
        "version of RASTrainer": rastrainer.__version__,
    }
    planned = trainees * len(protocol.modes) * len(protocol.tasks) * protocol.repetitions
    counts = dict.fromkeys(("found", "played", "stuck"), 0)
    simulated_s = 0.0
    with Study.open(folder / DATABASE) as study:
        store = CohortStore(study)
        store.start(plan, planned)
        StudyProgress(study).set_protocol(protocol)
        write_text(folder / PROTOCOL, protocol_text(protocol))
        write_text(folder / TRUTH, json.dumps(truth, indent=2) + "\n")
        if records is not None:
            records.mkdir(exist_ok=True)
        jobs = [*trial_jobs(protocol, population, trainees, seed)]
        missing = [job for job in jobs if not store.has_played(job.trial_id)]
        counts["found"] = len(jobs) - len(missing)
        trials = run_jobs(
            *(function, missing, engine, workers, address),
            name_of=lambda job: f"The trial of {job.trainee}, {job.task} ({job.mode}),",
        )
        for trial in trials:
            if trial.analysis is None:
                store.add_stuck(trial.job.trial_id)
            else:
                store.add(trial.analysis)
                simulated_s += trial.analysis.record.completion_time_s
            counts["stuck" if trial.analysis is None else "played"] += 1
            on_trial(sum(counts.values()))
        store.finish()
    return CohortRun(**counts, seconds=time.perf_counter() - start, simulated_s=simulated_s)


def _virtual(protocol: StudyProtocol, with_journals: bool) -> StudyProtocol:
    """Return the protocol as virtual trainees play it; raise `InputError` if they cannot."""
    if with_journals and protocol.procedures:
        raise InputError(
            "The journals of virtual trainees contain only the touches: leave out --records, or "
            "the protocol's procedures."
        )
    if protocol.methods:
        raise InputError(
            "Virtual trainees touch fiducials: leave the protocol's methods out. To compare "
            "methods in simulated trials, use rastrainer compare-methods."
        )
    return replace(
        protocol,
        title=f"{protocol.title[:90]} (virtual trainees)",
        trial_run_min=0.0,
        break_between_modes_min=0.0,
        break_between_tasks_min=0.0,
        questionnaires=(),
    )
