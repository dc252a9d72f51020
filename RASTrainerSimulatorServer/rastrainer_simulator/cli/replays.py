"""Commands for replays of recorded trials: `rastrainer replay` and `rastrainer rate`."""

from __future__ import annotations

import argparse
import json
import random
import sys
from dataclasses import asdict
from functools import partial

from rastrainer.errors import InputError
from rastrainer.journal.journal_file import read_journal
from rastrainer.study.database.study import Study
from rastrainer.study.ratings import FORMS, RatingStore, find_form
from rastrainer_simulator.cli import arg
from rastrainer_simulator.cli.options import Subcommand, announce

REPLAYS = 20


def replay(arguments: argparse.Namespace) -> int:
    if arguments.film is not None:
        return _film(arguments)
    if not arguments.verify:
        from rastrainer_simulator.server.replay_server import show

        playback = arguments.scenario, arguments.view_port, arguments.window
        show(arguments.journal, *playback, partial(announce, "replay"))
        return 0
    # Only here: the robot and the scenario take time to import.
    from rastrainer_simulator.record.trial_context import setup_of
    from rastrainer_simulator.replay import resimulation

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
    # Only here: the robot and the scenario take time to import.
    from rastrainer.journal.recording import read_track
    from rastrainer_simulator.record.trial_context import setup_of
    from rastrainer_simulator.replay.film import write_film
    from rastrainer_simulator.replay.recorded_trial import RecordedTrial

    if not 0.1 <= arguments.speed <= 20.0:
        raise InputError("--speed must be from 0.1 to 20 seconds of the trial per second.")
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
    # Only here: the robot and the scenario take time to import.
    from rastrainer_simulator.rating.rating_work import RatingWork
    from rastrainer_simulator.server.replay_server import serve_rating, trials_to_show

    tell = partial(announce, "rating")
    forms = [find_form(name) for name in dict.fromkeys(arguments.form or FORMS)]
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


PLAYBACK = (
    arg.port("--view-port", None, "where views are served"),
    arg.switch("--window", "open the window"),
)
COMMANDS = (
    Subcommand(
        "replay",
        "show a recorded trial, or simulate it again and compare it bit by bit",
        replay,
        (
            arg.path("journal", "JOURNAL"),
            arg.path("--scenario", "DIR", "the scenario it was recorded with"),
            arg.flag(
                "--verify",
                "simulate the trial again and compare it with the journal instead of showing it",
            ),
            arg.flag("--json", "print the report of --verify as JSON"),
            arg.path("--film", "FILE.webm", "write the trial as a film instead of showing it"),
            arg.number("--speed", 1.0, "seconds of the trial per second of the film"),
            *PLAYBACK,
        ),
        "Shows the trial in the window and to every view; Escape ends it. Exit status: 0 shown, or "
        "equal to the last bit; 1 something differs; 2 not replayable.",
    ),
    Subcommand(
        "rate",
        "mark replays of a study's trials on GEARS and OSATS forms, blinded",
        rate,
        (
            arg.study(),
            arg.option(
                "--rater",
                required=True,
                metavar="NAME",
                help="a pseudonym of who rates, such as R1",
            ),
            arg.RECORDS,
            arg.number(
                "--replays", REPLAYS, "how many trials are drawn for all raters", 1, metavar="N"
            ),
            arg.option(
                "--form",
                action="append",
                choices=list(FORMS),
                help="may be given several times (default: all)",
            ),
            arg.path("--scenario", "DIR", "the scenario they were recorded with"),
            *PLAYBACK,
        ),
        "Shows the replays of trials in the window and to every view, under shuffled numbers, "
        "without trainee, date, score or mode, and takes a rater's marks, which are kept in the "
        "study. All raters get the same trials, each in another order. Work can be left at any "
        "time; the same command takes it up. The study's report shows how far raters agree.",
    ),
)
