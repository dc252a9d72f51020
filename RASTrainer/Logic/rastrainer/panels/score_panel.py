"""The section Score: a trial's scores and their parts, its motion, and how it stands."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import qt
import slicer

from rastrainer.ctps import CTPS_WARNING
from rastrainer.errors import InputError
from rastrainer.panels.widgets import chosenData, fillComboBox, fillTable, setSentence, setUsable
from rastrainer.report.report import write_report
from rastrainer.report.study_data import read_study_data
from rastrainer.slicer.score_board import (
    Standing,
    motionRows,
    scoreRows,
    showMotion,
    showScore,
    showStandings,
    standings,
)
from rastrainer.slicer.session import Session
from rastrainer.slicer.translation import _
from rastrainer.slicer.trial_desk import ScoredTrial
from rastrainer.study import StoredTrial


class ScorePanel:
    """Wires the section's widgets to the session."""

    def __init__(self, ui: Any, session: Session) -> None:
        self._ui = ui
        self._session = session
        self._trainees = session.trainees
        ui.trialComboBox.connect("activated(int)", self._showTrial)
        ui.showTablesButton.connect("clicked()", self.showTables)
        ui.exportScoresButton.connect("clicked()", self.exportScores)
        ui.reportButton.connect("clicked()", self.writeReport)
        ui.replayButton.connect("clicked()", self.replay)
        ui.worstTouchButton.connect("clicked()", self.replayWorstTouch)
        self._trainees.changed.connect(self._show)
        session.trials.trialScored.connect(self._showNewTrial)
        self._show()

    def close(self) -> None:
        """Listen to the session no more."""
        self._trainees.changed.disconnect(self._show)
        self._session.trials.trialScored.disconnect(self._showNewTrial)

    def showTables(self) -> None:
        """Put what is shown here into table nodes of the scene."""
        with slicer.util.tryWithErrorDisplay(_("The tables cannot be shown.")):
            trial = self._trial()
            if trial is None:
                return
            showScore(slicer.mrmlScene, scoreRows(trial, self._session.cohort))
            showStandings(slicer.mrmlScene, self._standings(trial))
            showMotion(slicer.mrmlScene, motionRows(trial))
            self._ui.scoreMessageText.text = _(
                "Score, Comparison and Motion metrics are tables of the scene now."
            )

    def exportScores(self) -> None:
        """Write all trials of the study as a table."""
        caption = _("Export all trials")
        path = qt.QFileDialog.getSaveFileName(
            slicer.util.mainWindow(), caption, "trials.csv", "CSV (*.csv)"
        )
        if path:
            with slicer.util.tryWithErrorDisplay(_("The trials were not exported.")):
                count, leftOut = self._trainees.exportHistories(Path(path))
                self._ui.scoreMessageText.text = _(
                    "{count} trials are written to {path}. Trainees left out because they did not "
                    "agree to research: {leftOut}."
                ).format(count=count, path=path, leftOut=leftOut)

    def writeReport(self) -> None:
        """Write the report of the whole study into a folder, and open it."""
        caption = _("Folder for the report")
        folder = qt.QFileDialog.getExistingDirectory(slicer.util.mainWindow(), caption)
        if folder:
            with slicer.util.tryWithErrorDisplay(_("The report was not written."), waitCursor=True):
                data = read_study_data(self._session.studyPath)
                page = write_report(data, Path(folder)).page
                self._ui.scoreMessageText.text = _("The report is {path}.").format(path=page)
                qt.QDesktopServices.openUrl(qt.QUrl.fromLocalFile(str(page)))

    def replay(self) -> None:
        """Show the trial again in the 3D view."""
        with slicer.util.tryWithErrorDisplay(_("The trial is not shown."), waitCursor=True):
            self._session.replay.show(self._trial())

    def replayWorstTouch(self) -> None:
        """Show again how the worst touch came about."""
        with slicer.util.tryWithErrorDisplay(_("The touch is not shown."), waitCursor=True):
            self._session.replay.showWorstTouch(self._trial())

    def showState(self) -> None:
        """Show where the replay stands, which plays by itself."""
        setSentence(self._ui.replayText, self._session.replay.sentence)

    def _showNewTrial(self, trial: ScoredTrial) -> None:
        """Show a trial that has just been scored, if its trainee is the chosen one."""
        record = trial.analysis.record
        if record.trainee == self._trainees.chosen:
            self._show(record.trial_id)

    def _show(self, chosen: str = "") -> None:
        try:
            history = self._trainees.history()
        except InputError as error:
            self._ui.scoreMessageText.text = str(error)
            return
        entries = [(_entry(n, t), t.record.trial_id) for n, t in enumerate(history, start=1)]
        entries.reverse()
        known = [trialId for _title, trialId in entries]
        wanted = chosen or chosenData(self._ui.trialComboBox)
        fillComboBox(
            self._ui.trialComboBox,
            entries,
            wanted if wanted in known else known[0] if known else "",
        )
        self._showTrial()

    def _showTrial(self, _index: int = 0) -> None:
        ui = self._ui
        try:
            trial = self._trial()
            beside = [] if trial is None else self._standings(trial)
        except InputError as error:
            ui.scoreMessageText.text = str(error)
            return
        scores = [] if trial is None else scoreRows(trial, self._session.cohort)
        motion = [] if trial is None else motionRows(trial)
        fillTable(
            ui.scoreTable,
            ((row.title, row.text, _shortened(row.note)) for row in scores),
            [row.note for row in scores],
        )
        fillTable(ui.standingsTable, (_standingRow(s) for s in beside))
        fillTable(
            ui.motionTable,
            ((row.title, row.text) for row in motion),
            [row.note for row in motion],
        )
        hasCtps = any(row.note == CTPS_WARNING for row in scores)
        setSentence(ui.ctpsText, CTPS_WARNING if hasCtps else "")
        ui.scoreMessageText.text = (
            _("Choose a trainee with a scored trial.")
            if trial is None
            else _("{trainee}, {task}, {mode}").format(
                trainee=trial.record.trainee, task=trial.record.task, mode=trial.record.mode
            )
        )
        setUsable(
            ui.showTablesButton,
            trial is not None,
            _("Put score, comparison and motion metrics into table nodes of the scene."),
            _("Choose a trial first."),
        )
        self._showFeedback(trial)

    def _showFeedback(self, trial: StoredTrial | None) -> None:
        ui, sentences, worst = self._ui, [], ""
        if trial is not None:
            try:
                feedback = self._session.replay.feedback(trial)
            except InputError as error:
                sentences = [str(error)]
            else:
                sentences, worst = feedback.sentences, feedback.worst.label
        setSentence(ui.feedbackText, "\n".join(sentences))
        hasTrial, reason = trial is not None, _("Choose a trial first.")
        setUsable(
            ui.replayButton,
            hasTrial,
            _("Show the tool, the touches and the clearance over time, as a Sequence."),
            reason,
        )
        setUsable(
            ui.worstTouchButton,
            bool(worst),
            _("Show how point {label} was touched.").format(label=worst),
            reason if not hasTrial else _("The trial cannot be judged."),
        )

    def _trial(self) -> StoredTrial | None:
        trialId = chosenData(self._ui.trialComboBox)
        return self._trainees.study.trial(trialId) if trialId else None

    def _standings(self, trial: StoredTrial) -> list[Standing]:
        return standings(self._trainees.study, trial, self._session.cohort)


def _entry(number: int, trial: StoredTrial) -> str:
    return _("{number}: {task}, {day}").format(
        number=number,
        task=trial.record.task,
        day=trial.record.started_utc[:16].replace("T", " "),
    )


def _shortened(note: str) -> str:
    return _("see below") if note == CTPS_WARNING else note


def _standingRow(standing: Standing) -> tuple[str, ...]:
    return (
        f"{standing.title} ({standing.unit})" if standing.unit else standing.title,
        f"{standing.value:.2f}",
        standing.group,
        str(standing.count),
        f"{standing.median:.2f}",
        f"{100 * standing.betterThan:.0f} %",
    )
