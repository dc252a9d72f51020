"""`rastrainer rate STUDY --rater NAME`: mark replays on rating forms, without knowing whose."""

from __future__ import annotations

import argparse
import random
from functools import partial
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.study.database.study import Study
from rastrainer.study.ratings import FORMS, RatingStore, find_form
from rastrainer_simulator.cli.options import (
    add_playback,
    add_records,
    add_study,
    announce,
    check_ports,
)
from rastrainer_simulator.rating.rating_pages import RatingWork

REPLAYS = 20


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand to the parser of `rastrainer`."""
    parser = subparsers.add_parser(
        "rate",
        help="mark replays of a study's trials on GEARS and OSATS forms, blinded",
        description=(
            "Shows the replays of trials in the window and to every view, under shuffled numbers, "
            "without trainee, date, score or mode, and takes a rater's marks, which are kept in "
            "the study. All raters get the same trials, each in another order. Work can be left "
            "at any time; the same command takes it up. The study's report shows how far raters "
            "agree."
        ),
    )
    add_study(parser)
    parser.add_argument(
        "--rater", required=True, metavar="NAME", help="a pseudonym of who rates, such as R1"
    )
    add_records(parser)
    parser.add_argument(
        "--replays",
        type=int,
        default=REPLAYS,
        metavar="N",
        help="how many trials are drawn for all raters (default: %(default)s)",
    )
    parser.add_argument(
        "--form",
        action="append",
        choices=list(FORMS),
        help="may be given several times (default: all)",
    )
    parser.add_argument(
        "--scenario", type=Path, metavar="DIR", help="the scenario they were recorded with"
    )
    add_playback(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Let the rater work, say how far that went, and return the exit status.

    Raises:
        InputError: an argument is not usable, there is nothing to rate, or a replay cannot be
            shown.
    """
    check_ports(arguments)
    if arguments.replays < 1:
        raise InputError("--replays must be at least 1.")
    # Only here: the robot and the scenario take time to import.
    from rastrainer_simulator.server.replay_server import serve_rating, trials_to_show

    tell = partial(announce, "rating")
    forms = [find_form(name) for name in dict.fromkeys(arguments.form or FORMS)]
    with Study.open(arguments.study, must_exist=True) as study:
        store = RatingStore(study)
        trials = trials_to_show(study, arguments.records)
        order = store.assign(arguments.rater, trials, arguments.replays, random.SystemRandom())
        work = RatingWork(store, arguments.rater, order, forms)
        tell(f"has {len(order)} replays for {arguments.rater}, {work.rated} rated")
        playback = arguments.scenario, arguments.view_port, arguments.window
        serve_rating(work, arguments.records, *playback, tell)
        tell(f"is left: {work.rated} of {len(order)} replays are rated")
    return 0
