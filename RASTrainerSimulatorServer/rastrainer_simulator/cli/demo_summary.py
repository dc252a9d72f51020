"""Summarize the demo's results from the file that Slicer's side has written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.ctps import CTPS_WARNING
from rastrainer.trial.procedure_outcome import procedure_outcome
from rastrainer.trial.record import TrialRecord


def trial_summary(trial: Mapping[str, Any], title: str) -> str:
    """Return a summary of one trial for people; `trial` is a line of results.jsonl."""
    truth, target = trial["truth"], trial["target"]["name"]
    rigid = trial["fits"]["rigid"]
    low, high = rigid["tre_interval_mm"]
    where = (
        "below" if truth["true_tre_mm"] < low else "above" if truth["true_tre_mm"] > high else "in"
    )
    undone, refused = trial["undone_touches"], trial["rejected_touches"]
    lines = [
        f"{title}, {trial['trainee']}, {trial['mode']}",
        _line("Completion time (CT)", trial["completion_time_s"], "s"),
        f"  Touches: {undone} undone, {refused} refused",
        *(_line(f"FRE, {kind}", fit["fre_mm"], "mm") for kind, fit in trial["fits"].items()),
        _line(
            f"Expected TRE, {target}",
            rigid["expected_tre_mm"],
            f"mm, 95 % interval from {low:.2f} to {high:.2f}",
        ),
        f"    {INTERVAL_NOTE}",
        _line(f"True TRE, {target}", truth["true_tre_mm"], f"mm, {where} that interval"),
        *_scores(trial["score"], trial["ctps"]),
        "  Residual of each fiducial, rigid (mm)",
        *_residuals(trial["labels"], rigid["residuals_mm"]),
    ]
    lines += [f"  Warning: {warning['message']}" for warning in rigid["warnings"]]
    return "\n".join(lines)


def procedure_summary(record: TrialRecord, scenario: Scenario, head_to_world: np.ndarray) -> str:
    """Return a summary of the errors of a trial's procedure against the truth, for people.

    `head_to_world` is the true pose, (4, 4) float, mm.
    """
    outcome = procedure_outcome(record, scenario, head_to_world)
    assert outcome is not None, "the trial has a procedure"
    procedure = scenario.procedure(outcome.analysis.record.procedure)
    lines = [f"{procedure.title}, errors by registration and by hand in brackets"]
    for each in outcome.analysis.trajectories:
        lines.append(f"  {each.trajectory.name}")
        for name, error in (("Target point error", each.target), ("Entry point error", each.entry)):
            parts = f"({error.registration_mm:.2f} and {error.hand_mm:.2f})"
            lines.append(_line(f"  {name}", error.length_mm, f"mm {parts}"))
        parts = f"({each.registration_angle_deg:.2f} and {each.hand_angle_deg:.2f})"
        lines.append(_line("  Angular deviation", each.angle_deg, f"° {parts}"))
        lines.append(_line("  Plunge depth", each.plunge_mm or 0.0, "mm"))
    lines.append(_line("Score of the procedure", outcome.score.score, "of 100"))
    return "\n".join(lines)


def _line(name: str, value: float, unit_and_remark: str) -> str:
    return f"  {name:<34} {value:8.2f} {unit_and_remark}"


def _scores(score: Mapping[str, Any], ctps: Mapping[str, Any]) -> list[str]:
    time, accuracy = score["time_desirability"], score["accuracy_desirability"]
    return [
        _line("Score", score["score"], f"of 100: time {time:.2f}, accuracy {accuracy:.2f}"),
        _line("CTPS as in the paper's tables", ctps["published"], "against the paper's cohort"),
        _line("CTPS by the paper's equation 3", ctps["equation_3"], "half of it"),
        f"    {CTPS_WARNING}",
    ]


def _residuals(labels: Sequence[str], residuals_mm: Sequence[float]) -> list[str]:
    longest = max(residuals_mm)
    bars = ["▇" * max(1, round(20 * residual / longest)) for residual in residuals_mm]
    rows = zip(labels, residuals_mm, bars, strict=True)
    return [f"    {label:>3}  {residual:5.2f}  {bar}" for label, residual, bar in rows]
