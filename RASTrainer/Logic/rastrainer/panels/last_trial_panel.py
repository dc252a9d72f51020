"""The section Last trial: the numbers of the trial that arrived last."""

from __future__ import annotations

from typing import Any

from rastrainer.slicer.translation import _
from rastrainer.slicer.trial_desk import ScoredTrial, TrialDesk


class LastTrialPanel:
    """Shows what the desk tells.

    Args:
        ui: the widgets of `RASTrainer.ui`.
        desk: at which finished trials arrive.
    """

    def __init__(self, ui: Any, desk: TrialDesk) -> None:
        self._ui = ui
        self._desk = desk
        desk.trialScored.connect(self._show)
        desk.problemFound.connect(self._showProblem)

    def close(self) -> None:
        """Listen to the desk no more."""
        self._desk.trialScored.disconnect(self._show)
        self._desk.problemFound.disconnect(self._showProblem)

    def _show(self, trial: ScoredTrial) -> None:
        analysis, ui = trial.analysis, self._ui
        record, expected = analysis.record, analysis.expected_tre
        low, high = expected.interval_mm
        ui.trialText.text = _("{trainee}, {task}, {mode}").format(
            trainee=record.trainee, task=record.task, mode=record.mode
        )
        ui.timeText.text = f"{record.completion_time_s:.1f} s"
        ui.freText.text = f"{analysis.rigid.fre_mm:.2f} mm"
        ui.expectedTreText.text = _("{expected:.2f} mm (95 %: {low:.2f} to {high:.2f} mm)").format(
            expected=expected.expected_mm, low=low, high=high
        )
        ui.trueTreText.text = f"{trial.truth.true_tre_mm:.2f} mm"
        ui.scoreText.text = f"{analysis.score.score:.1f}"
        ui.warningsText.text = "\n".join(warning.message for warning in analysis.rigid.warnings)

    def _showProblem(self, sentence: str) -> None:
        ui = self._ui
        ui.trialText.text = sentence
        for label in (
            ui.timeText,
            ui.freText,
            ui.expectedTreText,
            ui.trueTreText,
            ui.scoreText,
            ui.warningsText,
        ):
            label.text = ""
