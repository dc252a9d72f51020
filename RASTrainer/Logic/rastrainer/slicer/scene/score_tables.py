"""One trial's scores with their parts, its motion, and its comparison with other trials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer.number_text import fixed
from rastrainer.registration.fits import RIGID
from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.slicer.scene.nodes import Role
from rastrainer.slicer.scene.tables import Column, showTable
from rastrainer.slicer.translation import _
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import StoredTrial
from rastrainer.study.outcomes import MOTION_METRICS
from rastrainer.trial.analysis import published_score
from rastrainer.trial.ctps import CTPS_WARNING, Trial
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.scoring import (
    COMMON_BIAS_LIMIT_MM,
    CONTACT_LIMIT_S,
    CONTACT_PATH_LIMIT_MM,
    DEPTH_LIMIT_MM,
    TrialScore,
)


@dataclass(frozen=True)
class Row:
    """One line of the score: title, value, unit and note.

    `more` is added to the note in the tool tip.
    """

    title: str
    value: float | None
    unit: str = ""
    note: str = ""
    more: str = ""

    @property
    def text(self) -> str:
        """The value with its unit, as people read it."""
        if self.value is None:
            return "–"
        digits = 0 if self.unit == "" and float(self.value).is_integer() else 2
        return f"{fixed(self.value, digits)} {self.unit}".rstrip()

    @property
    def tip(self) -> str:
        """The note with what goes beyond it."""
        return "\n".join(filter(None, (self.note, self.more)))


@dataclass(frozen=True)
class GroupComparison:
    """A value beside those of a group.

    Attributes:
        title: what is compared.
        unit: of the value.
        value: of the trial.
        group: of whom the others are.
        count: how many others there are, at least one.
        median: of the others.
        betterThan: share of the others that the trial is better than, 0 to 1.
    """

    title: str
    unit: str
    value: float
    group: str
    count: int
    median: float
    betterThan: float


def scoreRows(trial: StoredTrial) -> list[Row]:
    """Return the score of a trial with its results, and its parts."""
    score, rigid = trial.score, trial.registrations.get(RIGID)
    rows = []
    if score is not None:
        rows += _parts(score)
    paused = trial.record.motion.get("pause_time_s", 0.0)
    note = _("{s:.0f} s of pauses are left out").format(s=paused) if paused else ""
    rows.append(Row(_("Completion time"), trial.record.completion_time_s, "s", note))
    if rigid is not None:
        fre = _("does not predict TRE")
        rows += [
            Row(_("FRE (RMSE)"), rigid.fre_mm, "mm", fre),
            Row(
                _("Expected TRE"),
                rigid.expected_tre_mm,
                "mm",
                _interval(rigid.tre_interval_mm),
                INTERVAL_NOTE,
            ),
        ]
    rows += [] if trial.procedure is None else _procedureRows(trial.procedure)
    rows.append(
        Row(_("True TRE at the target"), trial.true_tre_mm, "mm", _("only a simulator knows it"))
    )
    return rows


def _procedureRows(procedure: ProcedureOutcome) -> list[Row]:
    """Return the score of a procedure, beside that of the touches, and its errors."""
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
    """Return a score and its parts."""
    version = _("Version {v}") if score.acceptable else _("not acceptable; version {v}")
    rows = [
        Row(_("Score"), score.score, "/ 100", version.format(v=score.version)),
        Row(_("… its part for time"), 100 * score.time_desirability, "%"),
        Row(
            _("… its part for accuracy"),
            100 * score.accuracy_desirability,
            "%",
            _accuracyNote(score),
        ),
    ]
    measures, limit_mm = score.measures, score.reference.limit_mm
    error = "; ".join([_("RMS over targets and brain"), _limit(limit_mm, "mm")])
    safety = _("within the limits") if score.is_safe else _("beyond a limit")
    return [
        *rows,
        Row(_("… its part for safety"), 100 * score.safety_desirability, "%", safety),
        Row(_("True TRE in the brain"), measures.tre_mm, "mm", error),
        *_bias(measures.common_bias_mm),
        Row(_("Unintended contact"), measures.contact_time_s, "s", _limit(CONTACT_LIMIT_S, "s")),
        Row(_("… its path"), measures.contact_path_mm, "mm", _limit(CONTACT_PATH_LIMIT_MM, "mm")),
        Row(_("Pressing depth"), measures.pressing_depth_mm, "mm", _limit(DEPTH_LIMIT_MM, "mm")),
    ]


def _accuracyNote(score: TrialScore) -> str:
    if score.is_unbiased is None:
        note = _("within the limit of {limit:g} mm")
        if not score.is_accurate:
            note = _("beyond the limit of {limit:g} mm")
        return note.format(limit=score.reference.limit_mm)
    is_within = score.is_accurate and score.is_unbiased
    return _("within the limits") if is_within else _("beyond a limit")


def _bias(bias_mm: float | None) -> list[Row]:
    """Return the row of the common bias, which trials without fiducials lack."""
    if bias_mm is None:
        return []
    limit = _limit(COMMON_BIAS_LIMIT_MM, "mm")
    return [Row(_("Bias that all touches share"), bias_mm, "mm", limit)]


def _limit(value: float, unit: str) -> str:
    return _("at most {value:g} {unit}").format(value=value, unit=unit)


def ctpsRows(trial: StoredTrial, cohort: Sequence[Trial]) -> list[Row]:
    """Return the scores of the publication, none where they cannot be computed.

    Args:
        trial: with its results.
        cohort: trials that CTPS compares with; those of the trial's own mode count.
    """
    rigid = trial.registrations.get(RIGID)
    found = None if rigid is None else published_score(trial.record, rigid.fre_mm, cohort)
    if found is None:
        return []
    return [
        Row(_("CTPS as published"), found.published, "", CTPS_WARNING),
        Row(_("CTPS by equation 3"), found.equation_3, "", _("half of it, as printed")),
    ]


def motionRows(trial: StoredTrial) -> list[Row]:
    """Return the motion metrics of a trial, each with its definition."""
    return [
        Row(metric.title, trial.record.motion[name], metric.unit, metric.definition)
        for name, metric in MOTION_METRICS.items()
        if name in trial.record.motion
    ]


def standings(
    study: Study, trial: StoredTrial, cohort: Sequence[Trial] = ()
) -> list[GroupComparison]:
    """Compare a trial with the trainee's own others, with everyone else's, and with a cohort.

    Only trials of the same task and mode are compared, and only scores of the same method.

    Args:
        study: of the trial.
        trial: with its results.
        cohort: of another study, such as the published one; its times and FRE are known.
    """
    record = trial.record
    outcomes = study.outcomes(record.task, record.mode)
    (this,) = (o for o in outcomes if o.trial_id == record.trial_id)
    own = [o for o in outcomes if o.trainee == record.trainee and o is not this]
    others = [o for o in outcomes if o.trainee != record.trainee]
    found = []
    for group, members in ((_("own"), own), (_("others"), others)):
        for title, unit, better, name in _COMPARED:
            value = getattr(this, name)
            peers = members
            if name == "score":
                peers = [o for o in members if o.method == this.method]
            values = [v for v in (getattr(o, name) for o in peers) if v is not None]
            if value is not None and values:
                found.append(_standing(title, unit, value, group, values, better))
    return found + _comparedWithCohort(trial, cohort)


def showScore(scene: Any, rows: Sequence[Row]) -> Any:
    """Show scores and their parts in a `vtkMRMLTableNode` and return it."""
    return _showRows(scene, Role.SCORE, "Score", rows)


def showMotion(scene: Any, rows: Sequence[Row]) -> Any:
    return _showRows(scene, Role.MOTION, "Motion metrics", rows)


def showStandings(scene: Any, found: Sequence[GroupComparison]) -> Any:
    """Show comparisons in a `vtkMRMLTableNode` and return it."""
    return showTable(
        scene,
        Role.COMPARISON,
        "Comparison",
        [
            Column("measure", [s.title for s in found], isText=True),
            Column("unit", [s.unit for s in found], isText=True),
            Column("value", [s.value for s in found]),
            Column("compared with", [s.group for s in found], isText=True),
            Column("trials", [s.count for s in found]),
            Column("median", [s.median for s in found]),
            Column("better than (share)", [s.betterThan for s in found]),
        ],
    )


def _showRows(scene: Any, role: str, name: str, rows: Sequence[Row]) -> Any:
    return showTable(
        scene,
        role,
        name,
        [
            Column("measure", [row.title for row in rows], isText=True),
            Column("value", [row.value for row in rows]),
            Column("unit", [row.unit for row in rows], isText=True),
            Column("note", [row.note for row in rows], isText=True),
        ],
    )


def _interval(ends: tuple[float, float] | None) -> str:
    return "" if ends is None else _("95 %: {:.2f} to {:.2f} mm").format(*ends)


def _standing(
    title: str, unit: str, value: float, group: str, values: Sequence[float], better: int
) -> GroupComparison:
    share = float(np.mean([better * value > better * other for other in values]))
    return GroupComparison(title, unit, value, group, len(values), float(np.median(values)), share)


def _comparedWithCohort(trial: StoredTrial, cohort: Sequence[Trial]) -> list[GroupComparison]:
    record, rigid = trial.record, trial.registrations.get(RIGID)
    # The published tables call the tasks 1 to 5.
    peers = [
        peer
        for peer in cohort
        if peer.mode == record.mode and record.task in (peer.task, f"task-{peer.task}")
    ]
    if not peers:
        return []
    group = _("reference")
    times = [peer.completion_time_s for peer in peers]
    found = [_standing(_("Completion time"), "s", record.completion_time_s, group, times, -1)]
    if rigid is not None:
        errors = [peer.rmse_mm for peer in peers]
        found.append(_standing(_("FRE (RMSE)"), "mm", rigid.fre_mm, group, errors, -1))
    return found


_COMPARED = (
    (_("Score"), "", 1, "score"),
    (_("Completion time"), "s", -1, "completion_time_s"),
    (_("True TRE"), "mm", -1, "true_tre_mm"),
)
"""Title, unit, 1 where more is better and −1 where less is, and the outcome's attribute."""
