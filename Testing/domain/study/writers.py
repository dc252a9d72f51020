"""Processes that store numbered trials in a study, some until they are killed."""

from __future__ import annotations

import json
import multiprocessing
import os
import subprocess
import sys

from rastrainer.study.database.study import Study
from Testing.domain.trial.trial_records import make_record

WRITER = """
import json, sys
from rastrainer.study.database.study import Study
path, record, first, last = sys.argv[1], json.loads(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
with Study.open(path) as study:
    for number in range(first, last):
        record["trialId"] = f"00000000-0000-0000-0000-{number:012d}"
        study.add_trial(record)
        print(number, flush=True)
"""


def writer(path, first, last):
    words = [sys.executable, "-c", WRITER, str(path), json.dumps(make_record()), str(first)]
    return subprocess.Popen([*words, str(last)], stdout=subprocess.PIPE, text=True)


def stored_numbers(path):
    with Study.open(path) as study:
        return sorted(int(t.record.trial_id[-12:]) for t in study.history("T-001"))


def write_until_killed(path, first, acknowledged):
    """Store numbered trials and report each one."""
    record = make_record()
    with Study.open(path) as study:
        for number in range(first, 100_000):
            record["trialId"] = f"00000000-0000-0000-0000-{number:012d}"
            study.add_trial(record)
            os.write(acknowledged, b"%d\n" % number)


class KilledWriter:
    """A process that stores trials as fast as possible until it is killed."""

    def __init__(self, path, first):
        context = multiprocessing.get_context("fork")
        self._receiving, sending = os.pipe()
        self._process = context.Process(target=write_until_killed, args=(path, first, sending))
        self._process.start()
        os.close(sending)

    def kill(self):
        """Kill it and return the numbers of the trials reported as stored."""
        self._process.kill()
        self._process.join()
        with os.fdopen(self._receiving) as lines:
            return {int(line) for line in lines}
