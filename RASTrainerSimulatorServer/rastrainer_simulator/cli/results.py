"""Commands for the results of a study: `rastrainer score` and `rastrainer report`."""

from __future__ import annotations

import argparse
from dataclasses import replace

from rastrainer.errors import InputError
from rastrainer.trial import ctps
from rastrainer.work_progress import print_progress
from rastrainer_simulator.cli.printing import json_text, picked, read_known_study, text_table


def score(arguments: argparse.Namespace) -> int:
    modes = ctps.trials_by_mode(ctps.read_trials(arguments.trials))
    notes = ctps.read_notes(arguments.trials.with_suffix(".json"))
    means = {**(notes.mean_ct_s if notes else {}), **_mean_times(arguments.mean_ct, list(modes))}
    scores = {mode: ctps.score_cohort(trials, means.get(mode)) for mode, trials in modes.items()}
    if arguments.json:
        names = ("overall", "equation_3_overall", "tasks", "subjects", "sd_population", "sd_sample")
        objects = {
            mode: {
                **picked(own, *names, "pearson_r", "r_squared"),
                "mean_ct": own.reference.mean_ct_s,
                "best_rmse": own.reference.best_rmse_mm,
                "trials": len(own.trials),
                "warning": ctps.CTPS_WARNING,
            }
            for mode, own in scores.items()
        }
        print(json_text(objects))
    else:
        print("\n\n".join(_scores_text(mode, own) for mode, own in scores.items()))
        print(f"\nWarning: {ctps.CTPS_WARNING}")
    return 0


def _scores_text(mode: str, scores: ctps.CohortScores) -> str:
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


def report(arguments: argparse.Namespace) -> int:
    # Only here: what `score` needs is imported much faster.
    from rastrainer_simulator.report.report import write_report

    data = read_known_study(arguments)
    means = _mean_times(arguments.mean_ct, list(data.modes))
    data = replace(data, mean_ct_s={**data.mean_ct_s, **means})
    page = write_report(data, arguments.output, progress=print_progress)
    aborted = f", {len(data.aborted)} aborted ones" if data.has_order else ""
    print(f"{page}: {len(data.trainees)} trainees, {len(data.trials)} trials{aborted}")
    return 0


def _mean_times(given: list[str], modes: list[str]) -> dict[str, float]:
    """Return mean times in s by mode, of `MODE=SECONDS` or `SECONDS` for all; the later counts."""
    means: dict[str, float] = {}
    for text in given:
        mode, separator, number = text.rpartition("=")
        if separator and mode not in modes:
            raise InputError(
                f"--mean-ct names the mode {mode[:64]!r}, but the trials have {', '.join(modes)}."
            )
        try:
            value = float(number)
        except ValueError:
            raise InputError(
                f"--mean-ct must be a number of seconds or MODE=SECONDS, not {text[:64]!r}."
            ) from None
        means.update(dict.fromkeys([mode] if separator else modes, value))
    return means
