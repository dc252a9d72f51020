"""Virtual trainees: time a trial, and how much faster a cohort is on all cores."""

import functools
import os
import time

from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer_simulator.virtual.cohort import run_jobs
from rastrainer_simulator.virtual.play import PlayedTrial, PlaySettings, play_job
from rastrainer_simulator.virtual.population import Population, trial_jobs
from Testing.benchmarks.row import row

TASKS = ("task-1", "task-2", "task-3", "task-4", "task-5")
QUICK_TASKS = TASKS[:2]


def rows(quick: bool) -> list[dict]:
    """Return the rows `cohort.trial`, `cohort.faster` and `cohort.speed_up`.

    `faster` is simulated over wall time of each trial on one core. `speed_up` is the time of all
    trials one after the other over that on all cores, the start of the processes included.
    """
    tasks = QUICK_TASKS if quick else TASKS
    protocol = StudyProtocol("bench", "Bench", ("desktop", "hmd"), "balanced", tasks, "fixed")
    jobs = list(trial_jobs(protocol, Population(), 1 if quick else 6, 0))
    play = functools.partial(play_job, settings=PlaySettings())
    for job in jobs[: len(tasks)]:
        # The paths over the head are computed once per process and task.
        play(job)
    played, seconds = zip(*(_timed(play, job) for job in jobs), strict=True)
    finished = [trial for trial in played if trial.analysis is not None]
    success = len(finished) / len(jobs)
    faster = [
        trial.analysis.record.completion_time_s / wall
        for trial, wall in zip(played, seconds, strict=True)
        if trial.analysis is not None
    ]
    began = time.perf_counter()
    there = list(run_jobs(play, jobs))
    speed_up = sum(seconds) / (time.perf_counter() - began)
    return [
        row("cohort.trial", seconds, "s", success=success),
        row("cohort.faster", faster, "×", success=success, worst=1),
        row(f"cohort.speed_up.{os.cpu_count()}", [speed_up], "×", success=success, n=len(there)),
    ]


def _timed(play, job) -> tuple[PlayedTrial, float]:
    began = time.perf_counter()
    trial = play(job)
    return trial, time.perf_counter() - began
