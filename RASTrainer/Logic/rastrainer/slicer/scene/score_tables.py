"""One trial's scores with their parts, its motion, and its comparison with other trials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass
from typing import Any

import numpy as np

from rastrainer.decision.drill_record import DrillRecord
from rastrainer.decision.drill_score import DRILL_SCORE_VERSION, DrillEstimate, drill_score
from rastrainer.number_text import fixed
from rastrainer.registration.fits import RIGID
from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.slicer.scene.nodes import NodeKind, Role
from rastrainer.slicer.scene.tables import showTable
from rastrainer.slicer.translation import _
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import StoredTrial
from rastrainer.study.outcomes import MOTION_METRICS
from rastrainer.trial.analysis import published_score
from rastrainer.trial.ctps import CTPS_WARNING, RMSE, TIME
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.scoring import (
    COMMON_BIAS_LIMIT_MM,
    CONTACT_LIMIT_S,
    CONTACT_PATH_LIMIT_MM,
    DEPTH_LIMIT_MM,
    TrialScore,
)
from rastrainer.trial.trial_row import TrialRow


@dataclass(frozen=True)
class Row:
    """One line of the score; `more` is added to the note in the tool tip."""

    title: str
    value: float | None
    unit: str = ""
    note: str = ""
    more: str = ""

    @property
    def text(self) -> str:
        if self.value is None:
            return "–"
        digits = 0 if self.unit == "" and float(self.value).is_integer() else 2
        return f"{fixed(self.value, digits)} {self.unit}".rstrip()

    @property
    def tip(self) -> str:
        return "\n".join(filter(None, (self.note, self.more)))


@dataclass(frozen=True)
class GroupComparison:
    """A value compared with a group; `betterThan` is the share that it beats, 0 to 1."""

    title: str
    unit: str
    value: float
    group: str
    count: int
    median: float
    betterThan: float


def scoreRows(trial: StoredTrial) -> list[Row]:
    score, rigid = trial.score, trial.registrations.get(RIGID)
    rows = [] if score is None else _parts(score)
    paused = trial.record.motion.get("pause_time_s", 0.0)
    note = _("{s:.0f} s of pauses are left out").format(s=paused) if paused else ""
    rows.append(Row(_("Completion time"), trial.record.completion_time_s, "s", note))
    if rigid is not None:
        rows.append(Row(_("FRE (RMSE)"), rigid.fre_mm, "mm", _("does not predict TRE")))
        interval = ""
        if rigid.tre_interval_mm is not None:
            interval = _("95 %: {:.2f} to {:.2f} mm").format(*rigid.tre_interval_mm)
        expected = rigid.expected_tre_mm
        rows.append(Row(_("Expected TRE"), expected, "mm", interval, INTERVAL_NOTE))
    if trial.procedure is not None:
        rows += _procedureRows(trial.procedure)
    rows.append(
        Row(_("True TRE at the target"), trial.true_tre_mm, "mm", _("only a simulator knows it"))
    )
    return rows


def _procedureRows(procedure: ProcedureOutcome) -> list[Row]:
    score, analysis = procedure.score, procedure.analysis
    version = _("Version {v}") if score.acceptable else _("not acceptable; version {v}")
    split = _("registration {registration} mm, hand {hand} mm")
    if analysis.self_aligned:
        split = _("registration {registration} mm, robot and hand {hand} mm")
    split = split.format(
        registration=fixed(analysis.target_point_error_by_registration_rms_mm, 2),
        hand=fixed(analysis.target_point_error_by_hand_rms_mm, 2),
    )
    over = _("RMS over {count} lines").format(count=len(analysis.trajectories))
    return [
        Row(_("Score of the procedure"), score.score, "/ 100", version.format(v=score.version)),
        Row(_("… target point error"), analysis.target_point_error_rms_mm, "mm", split, over),
        Row(_("… entry point error"), analysis.entry_point_error_rms_mm, "mm", over),
        Row(_("… angular deviation"), analysis.angular_deviation_rms_deg, "°", over),
        Row(_("… deepest plunge"), score.measures.plunge_mm, "mm", _("past the inner table")),
    ]


def _parts(score: TrialScore) -> list[Row]:
    version = _("Version {v}") if score.acceptable else _("not acceptable; version {v}")
    measures, limit_mm = score.measures, score.reference.limit_mm
    isAccurate, limit = score.is_accurate, _limit(COMMON_BIAS_LIMIT_MM, "mm")
    accuracy = _("within the limit of {limit:g} mm"), _("beyond the limit of {limit:g} mm")
    # Trials without fiducials lack the common bias.
    bias = []
    if score.is_unbiased is not None:
        isAccurate = isAccurate and score.is_unbiased
        accuracy = _("within the limits"), _("beyond a limit")
    if measures.common_bias_mm is not None:
        bias = [Row(_("Bias that all touches share"), measures.common_bias_mm, "mm", limit)]
    accuracyNote = accuracy[0 if isAccurate else 1].format(limit=limit_mm)
    error = "; ".join([_("RMS over targets and brain"), _limit(limit_mm, "mm")])
    safety = _("within the limits") if score.is_safe else _("beyond a limit")
    return [
        Row(_("Score"), score.score, "/ 100", version.format(v=score.version)),
        Row(_("… its part for time"), 100 * score.time_desirability, "%"),
        Row(_("… its part for accuracy"), 100 * score.accuracy_desirability, "%", accuracyNote),
        Row(_("… its part for safety"), 100 * score.safety_desirability, "%", safety),
        Row(_("True TRE in the brain"), measures.tre_mm, "mm", error),
        *bias,
        Row(_("Unintended contact"), measures.contact_time_s, "s", _limit(CONTACT_LIMIT_S, "s")),
        Row(_("… its path"), measures.contact_path_mm, "mm", _limit(CONTACT_PATH_LIMIT_MM, "mm")),
        Row(_("Pressing depth"), measures.pressing_depth_mm, "mm", _limit(DEPTH_LIMIT_MM, "mm")),
    ]


def drillRows(drill: DrillRecord) -> list[Row]:
    """Return the score of a drill of decisions, and the figures behind it."""
    score = drill_score(drill.cases)
    version = _("passed; version {v}") if score.is_passed else _("not passed; version {v}")
    beyond = sum(total for _missed, total in score.missed.values())
    faults = [f"{each.value}: {missed} / {total}" for each, (missed, total) in score.missed.items()]
    harm, vain = _("proceeded, of {n} beyond the limit"), _("refused, of {n} within it")
    return [
        Row(_("Score"), score.score, "/ 100", version.format(v=DRILL_SCORE_VERSION)),
        _estimateRow(_("Sensitivity d′"), score.sensitivity, _("0 for guesses")),
        _estimateRow(_("Criterion c"), score.criterion, _("above 0: proceeds too easily")),
        Row(_("Harmful decisions"), score.harmful, "", harm.format(n=beyond), "\n".join(faults)),
        Row(_("Vain decisions"), score.vain, "", vain.format(n=score.cases - beyond)),
        Row(_("Mean cost of a case"), score.mean_cost, "", _("a registration costs 1")),
        Row(_("Confidence (Brier score)"), score.brier, "", _("0 is best, 0.25 for always 50 %")),
        Row(_("Checked places per case"), score.mean_checks),
        Row(_("Time per case"), score.mean_time_s, "s"),
    ]


def _estimateRow(title: str, estimate: DrillEstimate, note: str) -> Row:
    interval = _("95 %: {:.2f} to {:.2f}").format(*estimate.interval)
    return Row(title, estimate.value, "", interval, note)


def _limit(value: float, unit: str) -> str:
    return _("at most {value:g} {unit}").format(value=value, unit=unit)


def ctpsRows(trial: StoredTrial, cohort: Sequence[TrialRow]) -> list[Row]:
    """Return the published scores; CTPS compares with the cohort's trials of the same mode."""
    rigid = trial.registrations.get(RIGID)
    found = None if rigid is None else published_score(trial.record, rigid.fre_mm, cohort)
    if found is None:
        return []
    return [
        Row(_("CTPS as published"), found.published, "", CTPS_WARNING),
        Row(_("CTPS by equation 3"), found.equation_3, "", _("half of it, as printed")),
    ]


def motionRows(trial: StoredTrial) -> list[Row]:
    return [
        Row(metric.title, trial.record.motion[name], metric.unit, metric.definition)
        for name, metric in MOTION_METRICS.items()
        if name in trial.record.motion
    ]


def standings(
    study: Study, trial: StoredTrial, cohort: Sequence[TrialRow] = ()
) -> list[GroupComparison]:
    """Compare a trial with the trainee's own others, with everyone else's, and with a cohort.

    Only trials of the same task and mode are compared, and only scores of the same method. A
    cohort, such as the published study, has only times and FRE.
    """
    record, rigid = trial.record, trial.registrations.get(RIGID)
    outcomes = study.outcomes(record.task, record.mode)
    (this,) = (o for o in outcomes if o.trial_id == record.trial_id)
    own = [o for o in outcomes if o.trainee == record.trainee and o is not this]
    others = [o for o in outcomes if o.trainee != record.trainee]
    # Title, unit, 1 where more is better and −1 where less is, value, group, and its values.
    compared: list[tuple[str, str, int, float | None, str, Sequence[float | None]]] = []
    for group, members in ((_("own"), own), (_("others"), others)):
        same = [o for o in members if o.method == this.method]
        for title, unit, better, name, peers in (
            (_("Score"), "", 1, "score", same),
            (_("Completion time"), "s", -1, "completion_time_s", members),
            (_("True TRE"), "mm", -1, "true_tre_mm", members),
        ):
            values = [o.values.get(name) for o in peers]
            compared.append((title, unit, better, this.values.get(name), group, values))
    # The published tables call the tasks 1 to 5.
    tasks = [
        (peer, (peer.task, f"task-{peer.task}")) for peer in cohort if peer.mode == record.mode
    ]
    published = [peer for peer, names in tasks if record.task in names]
    times, errors = ([p.values[name] for p in published] for name in (TIME, RMSE))
    fre = None if rigid is None else rigid.fre_mm
    compared += [
        (_("Completion time"), "s", -1, record.completion_time_s, _("reference"), times),
        (_("FRE (RMSE)"), "mm", -1, fre, _("reference"), errors),
    ]
    found = []
    for title, unit, better, value, group, all_ in compared:
        known = [each for each in all_ if each is not None]
        if value is not None and known:
            share = float(np.mean([better * value > better * other for other in known]))
            median = float(np.median(known))
            found.append(GroupComparison(title, unit, value, group, len(known), median, share))
    return found


def showStandings(scene: Any, found: Sequence[GroupComparison]) -> Any:
    titles = "measure", "unit", "value", "compared with", "trials", "median", "better than (share)"
    values = zip(*map(astuple, found), strict=True) if found else [()] * len(titles)
    return showTable(scene, Role.COMPARISON, dict(zip(titles, values, strict=True)))


def showRows(scene: Any, kind: NodeKind, rows: Sequence[Row]) -> Any:
    parts = {"measure": "title", "value": "value", "unit": "unit", "note": "note"}
    columns = {title: [getattr(row, part) for row in rows] for title, part in parts.items()}
    return showTable(scene, kind, columns)
