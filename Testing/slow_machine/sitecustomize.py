"""Makes a Python process behave as on a slow, busy machine: what a test must not depend on.

Python imports this module when it starts, wherever its folder is on `PYTHONPATH`: `make test
SLOW=7` has the tests and all processes that they start do so. Threads, work given to pools, disks
and the processes themselves are late by up to a second, at random; the number is the seed.
"""

import os
import random
import threading
import time
from concurrent.futures import ThreadPoolExecutor

LONGEST_START_S = 1.5
LONGEST_THREAD_S = 1.0
LONGEST_DISK_S = 0.15

_random = random.Random(f"{os.environ.get('RASTRAINER_SLOW')} {os.getpid()}")


def _be_late(share: float, longest_s: float) -> None:
    if _random.random() < share:
        time.sleep(_random.random() ** 2 * longest_s)


def _slow_down() -> None:
    run, submit, fsync = threading.Thread.run, ThreadPoolExecutor.submit, os.fsync

    def late_run(thread):
        _be_late(0.5, LONGEST_THREAD_S)
        run(thread)

    def late_submit(pool, work, /, *arguments, **named):
        # Of a journal's lines only those that reach the disk are slow: each line late would be a
        # disk that no simulator can write to.
        is_journal = pool._thread_name_prefix == "journal"

        def late_work(*arguments, **named):
            _be_late(0.0 if is_journal else 0.4, LONGEST_THREAD_S)
            return work(*arguments, **named)

        return submit(pool, late_work, *arguments, **named)

    def late_fsync(descriptor):
        _be_late(0.3, LONGEST_DISK_S)
        fsync(descriptor)

    threading.Thread.run = late_run
    ThreadPoolExecutor.submit = late_submit
    os.fsync = late_fsync
    _be_late(1.0, LONGEST_START_S)


if os.environ.get("RASTRAINER_SLOW"):
    _slow_down()
