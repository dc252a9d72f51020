"""`rastrainer score TRIALS.csv`: the paper's score of every trial of a study."""

from __future__ import annotations

import argparse
from typing import Any

from rastrainer.trial.ctps import (
    CTPS_WARNING,
    CohortScores,
    read_trials,
    score_cohort,
    trials_by_mode,
)
from rastrainer_simulator.cli.options import add_json, json_text, mean_times, text_table


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the command to a command line; `arguments.run(arguments)` runs it."""
    parser = subparsers.add_parser(
        "score",
        help="score the trials of a study as the paper does (CTPS)",
        description=(
            "Score the trials of a CSV file with the header mode,subject,task,ct,rmse (s and mm) "
            "with CTPS, separately for each mode."
        ),
    )
    parser.add_argument("trials", metavar="TRIALS.csv", help="one trial a row")
    parser.add_argument(
        "--mean-ct",
        action="append",
        default=[],
        metavar="[MODE=]SECONDS",
        help=(
            "use this mean completion time instead of the trials' own, such as a printed one; "
            "without MODE for all modes; may be given once for each mode"
        ),
    )
    add_json(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the scores and return the exit status.

    Raises:
        InputError: the file or a mean completion time cannot be used.
    """
    modes = trials_by_mode(read_trials(arguments.trials))
    means = mean_times(arguments.mean_ct, list(modes))
    scores = {mode: score_cohort(trials, means.get(mode)) for mode, trials in modes.items()}
    if arguments.json:
        objects = {mode: scores_json(score) for mode, score in scores.items()}
        print(json_text(objects))
    else:
        print("\n\n".join(scores_text(mode, score) for mode, score in scores.items()))
        print(f"\nWarning: {CTPS_WARNING}")
    return 0


def scores_json(scores: CohortScores) -> dict[str, Any]:
    """Return the scores of one mode as a JSON object; undefined values are None."""
    return {
        "overall": scores.overall,
        "equation_3_overall": scores.equation_3_overall,
        "tasks": scores.tasks,
        "subjects": scores.subjects,
        "sd_population": scores.sd_population,
        "sd_sample": scores.sd_sample,
        "pearson_r": scores.pearson_r,
        "r_squared": scores.r_squared,
        "mean_ct": scores.reference.mean_ct_s,
        "best_rmse": scores.reference.best_rmse_mm,
        "trials": len(scores.trials),
        "warning": CTPS_WARNING,
    }


def scores_text(mode: str, scores: CohortScores) -> str:
    """Return the scores of one mode as text for people."""
    reference = scores.reference
    rows = [[f"Task {name}", f"{mean:.2f}"] for name, mean in scores.tasks.items()]
    rows += [[f"Subject {name}", f"{mean:.2f}"] for name, mean in scores.subjects.items()]
    rows += [
        ["Overall, 100 (CT score - RMSE penalty)", f"{scores.overall:.2f}"],
        ["Overall by equation 3 (half of it)", f"{scores.equation_3_overall:.2f}"],
        ["Standard deviation, population", f"{scores.sd_population:.2f}"],
        ["Standard deviation, sample", _or_dash(scores.sd_sample, 2)],
        ["Pearson r of task number and mean CT", _or_dash(scores.pearson_r, 3)],
        ["r squared", _or_dash(scores.r_squared, 3)],
    ]
    title = (
        f"{mode}: {len(scores.trials)} trials, mean CT {reference.mean_ct_s:.3f} s, "
        f"best RMSE {reference.best_rmse_mm:.2f} mm"
    )
    return f"{title}\n{text_table(['', 'CTPS'], rows)}"


def _or_dash(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"
