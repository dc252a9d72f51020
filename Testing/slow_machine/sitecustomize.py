"""Makes a Python process as slow as on a busy machine; no test may depend on speed.

Python imports this module at its start if its folder is on `PYTHONPATH`: `make test SLOW=7` sets
that for the tests and all processes that they start. Threads, work given to pools, disks and
processes are late by up to a second, at random; or the code that started them, or sent something,
is held up, so that they are done before it looks. The number is the seed.
"""

import asyncio
import os
import random
import socket
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor, wait

LONGEST_START_S = 1.5
LONGEST_THREAD_S = 1.0
LONGEST_DISK_S = 0.15
LONGEST_HELD_UP_S = 0.4
LONGEST_AFTER_SENDING_S = 0.1

_random = random.Random(f"{os.environ.get('RASTRAINER_SLOW')} {os.getpid()}")


def _late(share: float, longest_s: float) -> float:
    return _random.random() ** 2 * longest_s if _random.random() < share else 0.0


def _sleep_randomly(share: float, longest_s: float) -> None:
    time.sleep(_late(share, longest_s))


def _delay_others() -> None:
    run, submit, fsync = threading.Thread.run, ThreadPoolExecutor.submit, os.fsync

    def late_run(thread):
        _sleep_randomly(0.5, LONGEST_THREAD_S)
        run(thread)

    def late_submit(pool, work, /, *arguments, **named):
        # Journal lines are slow only on the disk: if each were late, no simulator could write to
        # that disk.
        is_journal = pool._thread_name_prefix == "journal"

        def late_work(*arguments, **named):
            _sleep_randomly(0.0 if is_journal else 0.4, LONGEST_THREAD_S)
            return work(*arguments, **named)

        future = submit(pool, late_work, *arguments, **named)
        if not is_journal and not _is_in_loop():
            wait([future], _late(0.3, LONGEST_HELD_UP_S))
        return future

    def late_fsync(descriptor):
        _sleep_randomly(0.3, LONGEST_DISK_S)
        fsync(descriptor)

    threading.Thread.run = late_run
    ThreadPoolExecutor.submit = late_submit
    os.fsync = late_fsync


def _delay_thread_starts_and_sends() -> None:
    start, set_event = threading.Thread.start, threading.Event.set
    start_process, call_soon = subprocess.Popen.__init__, asyncio.BaseEventLoop.call_soon_threadsafe

    def start_and_wait(thread):
        start(thread)
        if not _is_in_loop():
            thread.join(_late(0.3, LONGEST_HELD_UP_S))

    def set_and_wait(event):
        set_event(event)
        _sleep_randomly(0.1, LONGEST_AFTER_SENDING_S)

    def start_process_and_wait(process, *arguments, **named):
        start_process(process, *arguments, **named)
        if not _is_in_loop():
            _sleep_randomly(0.3, LONGEST_START_S)

    def call_soon_and_wait(loop, *arguments, **named):
        handle = call_soon(loop, *arguments, **named)
        if not _is_in_loop():
            _sleep_randomly(0.2, LONGEST_AFTER_SENDING_S)
        return handle

    threading.Thread.start = start_and_wait
    threading.Event.set = set_and_wait
    subprocess.Popen.__init__ = start_process_and_wait
    asyncio.BaseEventLoop.call_soon_threadsafe = call_soon_and_wait
    for name in ("send", "sendall"):
        setattr(socket.socket, name, _held_up_after(getattr(socket.socket, name)))
    # Threads take turns where they rarely would.
    sys.setswitchinterval(_random.choice((1e-5, 5e-3, 5e-2)))


def _held_up_after(send):
    def send_and_wait(sender, *arguments):
        sent = send(sender, *arguments)
        if not _is_in_loop():
            _sleep_randomly(0.1, LONGEST_AFTER_SENDING_S)
        return sent

    return send_and_wait


def _is_in_loop() -> bool:
    """Return whether the caller is an event loop, on which real time depends."""
    return asyncio._get_running_loop() is not None


if os.environ.get("RASTRAINER_SLOW"):
    _delay_others()
    _delay_thread_starts_and_sends()
    _sleep_randomly(1.0, LONGEST_START_S)
