"""Shows an analyzed trial in the scene: touches on the head, transform, tables, residuals."""

from __future__ import annotations

from typing import Any

from rastrainer.scenario import Scenario
from rastrainer.slicer.registration_nodes import showRegistration
from rastrainer.slicer.residual_glyphs import showResidualArrows
from rastrainer.slicer.result_tables import showFits, showResiduals
from rastrainer.slicer.scenario import showScenario, showTask
from rastrainer.slicer.touches import showTouches
from rastrainer.trial_analysis import TrialAnalysis


def showTrial(scene: Any, scenario: Scenario, analysis: TrialAnalysis) -> None:
    """Replace what the scene shows by this trial; the touches are those of its record.

    Raises:
        InputError: the scenario's files cannot be used.
    """
    showScenario(scene, scenario)
    fixed = showTask(scene, scenario, analysis.record.task)
    moving = showTouches(scene, analysis.record)
    showRegistration(scene, analysis.rigid, moving, fixed)
    showResiduals(scene, analysis.rigid, analysis.rigid.leave_one_out_mm())
    kinds = list(analysis.fits)
    showFits(
        scene,
        [analysis.fits[kind] for kind in kinds],
        [analysis.target_errors[kind] for kind in kinds],
    )
    showResidualArrows(scene, analysis.rigid)
