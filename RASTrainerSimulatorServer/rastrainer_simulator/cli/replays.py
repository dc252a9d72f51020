"""Commands for replays of recorded trials: `rastrainer replay` and `rastrainer rate`."""

from __future__ import annotations

import argparse
import json
import random
import sys
from dataclasses import asdict
from functools import partial

from rastrainer.journal.journal_file import read_journal
from rastrainer.journal.recording import read_track
from rastrainer.study.database.study import Study
from rastrainer.study.ratings import FORMS, RatingStore
from rastrainer_simulator.cli.printing import announce
from rastrainer_simulator.rating.rating_work import RatingWork
from rastrainer_simulator.record.trial_context import setup_of
from rastrainer_simulator.replay import resimulation
from rastrainer_simulator.replay.film import write_film
from rastrainer_simulator.replay.recorded_trial import RecordedTrial
from rastrainer_simulator.server.replay_server import serve_rating, show, trials_to_show


def replay(arguments: argparse.Namespace) -> int:
    if arguments.film is not None:
        return _film(arguments)
    if not arguments.verify:
        playback = arguments.scenario, arguments.view_port, arguments.window
        show(arguments.journal, *playback, partial(announce, "replay"))
        return 0
    reading = read_journal(arguments.journal)
    report = resimulation.replay(reading, setup_of(reading.header, arguments.scenario))
    is_identical = report.difference is None
    if arguments.json:
        whole = {**asdict(report), "identical": is_identical, "journal": reading.sentence}
        print(json.dumps(whole, indent=2, allow_nan=False))
    else:
        print(_summary(reading.sentence, report))
    return 0 if is_identical else 1


def _film(arguments: argparse.Namespace) -> int:
    track = read_track(arguments.journal)
    setup = setup_of(track.header, arguments.scenario)
    tenths = 0

    def tell(share: float) -> None:
        nonlocal tenths
        if int(10 * share) > tenths:
            tenths = int(10 * share)
            print(f"{10 * tenths} %", file=sys.stderr)

    write_film(arguments.film, RecordedTrial(track, setup), setup, arguments.speed, tell)
    print(arguments.film)
    return 0


def _summary(sentence: str, report) -> str:
    kinds = ", ".join(f"{count} {kind}" for kind, count in sorted(report.compared.items()))
    lines = [
        f"Trial {report.trial_id}",
        f"  journal    {sentence}",
        f"  replayed   {report.ticks} ticks; compared: {kinds}",
        f"  result     {report.difference or 'equal to the last bit'}",
    ]
    for name, (recorded, present) in report.changed_versions.items():
        lines.append(f"  version    {name}: recorded with {recorded}, replayed with {present}")
    width = max(map(len, report.motion), default=0)
    lines += [f"  {name:<{width}}  {value:.6g}" for name, value in report.motion.items()]
    return "\n".join(lines)


def rate(arguments: argparse.Namespace) -> int:
    tell = partial(announce, "rating")
    forms = [FORMS[name] for name in dict.fromkeys(arguments.form or FORMS)]
    with Study.open(arguments.study, must_exist=True) as opened:
        store = RatingStore(opened)
        trials = trials_to_show(opened, arguments.records)
        order = store.assign(arguments.rater, trials, arguments.replays, random.SystemRandom())
        work = RatingWork(store, arguments.rater, order, forms)
        tell(f"has {len(order)} replays for {arguments.rater}, {work.rated} rated")
        playback = arguments.scenario, arguments.view_port, arguments.window
        serve_rating(work, arguments.records, *playback, tell)
        tell(f"is left: {work.rated} of {len(order)} replays are rated")
    return 0
