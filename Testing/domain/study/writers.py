"""Processes that store numbered trials in a study, some until they are killed."""

from __future__ import annotations

import multiprocessing
import os
import uuid

from rastrainer.study.database.study import Study
from Testing.domain.trial.trial_records import make_record


def stored_numbers(path):
    with Study.open(path) as study:
        return sorted(uuid.UUID(t.record.trial_id).int for t in study.history("T-001"))


def write(path, first, last, acknowledged):
    """Store numbered trials and report each one."""
    with Study.open(path) as study:
        for number in range(first, last):
            study.add_trial(make_record(number))
            os.write(acknowledged, b"%d\n" % number)


class Writer:
    """A process that stores trials as fast as possible, to the last or until it is killed."""

    def __init__(self, path, first, last=100_000):
        context = multiprocessing.get_context("fork")
        self._receiving, sending = os.pipe()
        self._process = context.Process(target=write, args=(path, first, last, sending))
        self._process.start()
        os.close(sending)

    def kill(self):
        """Kill it and return the numbers of the trials reported as stored."""
        self._process.kill()
        self._process.join()
        with os.fdopen(self._receiving) as lines:
            return {int(line) for line in lines}

    def finish(self):
        self._process.join(60)
        os.close(self._receiving)
        assert self._process.exitcode == 0
