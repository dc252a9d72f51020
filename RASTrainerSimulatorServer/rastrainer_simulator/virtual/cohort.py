"""A whole simulated study: played, and stored like a real study, with the truth in a file.

After an interruption (Ctrl-C, a full disk, a power failure) the same call resumes the study: its
jobs follow from the seed, and only those without a stored trial are played.
"""

from __future__ import annotations

import functools
import json
import multiprocessing
import os
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
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

Job = TypeVar("Job")
Result = TypeVar("Result")

ATTEMPTS = 3
"""How often in succession, without a result between, worker processes may be killed."""


def run_jobs(
    function: Callable[[Job], Result], jobs: Iterable[Job], workers: int | None = None
) -> Iterator[Result]:
    """Yield the result of each job, in their order; a single worker is this process.

    `function` can be pickled. If a worker process is killed, the jobs that have no result yet are
    done again.
    """
    workers = workers or os.cpu_count() or 1
    if workers == 1:
        yield from map(function, jobs)
        return
    # Not forked: collision meshes and threads of numpy do not survive that.
    context = multiprocessing.get_context("spawn")
    left, killed = deque(jobs), 0
    while left:
        pool = ProcessPoolExecutor(workers, context, _end_with_parent)
        try:
            for result in pool.map(function, tuple(left)):
                left.popleft()
                killed = 0
                yield result
        except BrokenProcessPool:
            killed += 1
            if killed == ATTEMPTS:
                raise InputError(
                    f"Worker processes were killed {ATTEMPTS} times. The computer may be short of "
                    "memory: try fewer workers, or --workers 1 to see the error itself. The trials "
                    "played so far are stored, and the same command resumes."
                ) from None
        finally:
            pool.shutdown(cancel_futures=True)


def _end_with_parent() -> None:
    """Let a worker process end when its parent is killed, and leave Ctrl-C to the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None, "A worker process has a parent."

    def follow() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


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
    workers: int | None = None,
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
        for trial in run_jobs(function, missing, workers):
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
