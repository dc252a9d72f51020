"""Which numbered trials of each simulator have arrived in a study, and which never did."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Mapping

from rastrainer.study.database.database import Connection
from rastrainer.trial.aborted_trial import AbortedTrial
from rastrainer.trial.record import TrialRecord


def note(connection: Connection, record: AbortedTrial | TrialRecord) -> None:
    """Note that a trial has arrived; one without a number, from elsewhere, leaves no trace."""
    if record.number and record.series:
        connection.execute(
            "INSERT INTO deliveries VALUES (?, ?) ON CONFLICT DO NOTHING",
            (record.series, record.number),
        )


def missing(connection: Connection) -> Mapping[str, tuple[tuple[int, int], ...]]:
    """Return the first and last numbers of each gap in what arrived, by series.

    A simulator numbers all trials that are started in its folder, so a gap is a trial that went to
    another study, that still waits there, or that somebody has made vanish.
    """
    query = "SELECT series, number FROM deliveries ORDER BY series, number"
    gaps = defaultdict(list)
    for (series, number), (same, following) in itertools.pairwise(connection.execute(query)):
        if same == series and following > number + 1:
            gaps[series].append((number + 1, following - 1))
    return {series: tuple(found) for series, found in gaps.items()}
