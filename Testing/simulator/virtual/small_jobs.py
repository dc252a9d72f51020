"""Jobs that square, fail or die, in a separate module that a new process loads quickly."""

import os
import signal
from pathlib import Path


def squared(number):
    return number * number


def squared_by_mortals(folder, doomed, times, number):
    if number in doomed:
        kill_self(folder, number, times)
    return squared(number)


def kill_self(folder: Path, job, times: int) -> None:
    """Kill this process by SIGKILL each of the first times that it is given a job."""
    for number in range(times):
        try:
            (folder / f"{job}-{number}").touch(exist_ok=False)
        except FileExistsError:
            continue
        os.kill(os.getpid(), signal.SIGKILL)


def refused(number):
    raise ZeroDivisionError(f"not {number}")
