"""The section Score: scores of a trial and their parts, its motion, and a comparison."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import qt
import slicer

from rastrainer.decision.drill_record import DrillRecord
from rastrainer.errors import InputError
from rastrainer.number_text import fixed
from rastrainer.sections.application import TABLES, askWhereToSave, fitThreeDViews, showTable
from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, connectClick
from rastrainer.slicer.scene.nodes import Role
from rastrainer.slicer.scene.score_tables import (
    GroupComparison,
    ctpsRows,
    drillRows,
    motionRows,
    scoreRows,
    showRows,
    showStandings,
    standings,
)
from rastrainer.slicer.scene.trial_replay import moment
from rastrainer.slicer.translation import _
from rastrainer.study.database.values import StoredTrial
from rastrainer.study.outcomes import short_mode_title, task_title
from rastrainer.trial.ctps import CTPS_WARNING
from rastrainer.trial.record import TrialRecord
from rastrainer.widgets.controls import (
    CancelableWork,
    chosenData,
    fillTable,
    offerEntries,
    setEnabled,
    setText,
    showPercent,
)


class ScorePanel(Panel):
    """The section Score."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._trainees = session.trainees
        failure = _("The trial is not shown.")
        self._showMessage = partial(setText, ui.scoreMessageText)
        shows = (self._showMessage, self._showUsable, partial(showPercent, ui.replayText))
        self._work = CancelableWork(ui.replayButton, self.replay, failure, *shows)
        self._trial: StoredTrial | None = None
        self._drill: DrillRecord | None = None
        self._newTrial = ""
        self._worst = ""
        self._named: str | None = None
        ui.trialComboBox.connect("activated(int)", self._showTrial)
        tables, section = ui.showTablesButton, ui.scoreCollapsibleButton
        failure = _("The tables cannot be shown.")
        self.borrowLayout(tables, section, TABLES, self.showTables, failure)
        connectClick(ui.exportScoresButton, self.exportScores, _("The trials were not exported."))
        connectClick(ui.reportButton, self.writeReport, _("The report was not written."))
        replayTouch = partial(self.replay, isWorstTouch=True)
        connectClick(ui.worstTouchButton, replayTouch, _("The touch is not shown."))
        self.listen(
            (self._trainees.changed, self._show),
            (session.trials.trialScored, lambda analysis: self._noteNew(analysis.record)),
            (session.trials.drillKept, self._noteNew),
            (session.replay.feedbackFound, self._showFeedback),
            (session.sceneChanged, self._showReplay),
        )
        self._show()

    def showTables(self) -> None:
        """Show the section's content as tables of the scene."""
        trial, cohort, scene = self._trial, self._session.cohort, slicer.mrmlScene
        rows = [] if self._drill is None else drillRows(self._drill)
        if trial is not None:
            showStandings(scene, standings(self._trainees.study, trial, cohort))
            showRows(scene, Role.MOTION, motionRows(trial))
            rows = [*scoreRows(trial), *ctpsRows(trial, cohort)]
        table = showRows(scene, Role.SCORE, rows)
        showTable(self._session.layout, table)
        text = _("Score, Comparison and Motion metrics are now tables in the scene.")
        self._showMessage(_("The score is now a table in the scene.") if trial is None else text)

    def exportScores(self) -> None:
        from rastrainer.study.tidy_csv import write_histories

        path = askWhereToSave(_("Export all trials"), "trials.csv", "CSV (*.csv)")
        if path is None:
            return
        write = partial(self._trainees.inStudy, lambda study: write_histories(study, path))
        written = self._work.run(write)
        if written is not None:
            text = _(
                "{count} trials were written to {path}. Trainees left out because they did not "
                "consent to research: {leftOut}."
            )
            self._showMessage(text.format(count=written[0], path=path, leftOut=written[1]))

    def writeReport(self) -> None:
        """Have the simulator write the report of the study into a folder, and open it."""
        simulator, caption = self._session.simulator, _("Folder for the report")
        if simulator.needsSetup:
            problem = _(
                "The simulator writes it, and is not set up yet: in the section Simulator, press "
                "Set up."
            )
            raise InputError(problem)
        folder = qt.QFileDialog.getExistingDirectory(slicer.util.mainWindow(), caption)
        command = ["report", str(self._session.studyPlace), "-o", folder]
        if folder and self._work.run(partial(simulator.run, command)) is not None:
            page = str(Path(folder, "report.html"))
            self._showMessage(_("The report is {path}.").format(path=page))
            qt.QDesktopServices.openUrl(qt.QUrl.fromLocalFile(page))

    def replay(self, isWorstTouch: bool = False) -> None:
        trial, replay = self._trial, self._session.replay
        if trial is not None:
            show = replay.showWorstTouch if isWorstTouch else replay.show
            self._work.run(partial(show, trial))
            if not isWorstTouch:
                fitThreeDViews()

    def _showReplay(self) -> None:
        if not self._work.isUnderWay:
            now = moment(slicer.mrmlScene)
            text = _("{time:.1f} s, clearance {clearance}")
            shown = "" if now is None else text.format(time=now[0], clearance=now[1])
            setText(self._ui.replayText, shown)

    def _noteNew(self, record: TrialRecord | DrillRecord) -> None:
        if record.trainee == self._trainees.chosen:
            self._newTrial = record.trial_id

    def _show(self) -> None:
        try:
            results = self._trainees.results()
        except InputError as error:
            self._named = None
            self._showMessage(str(error))
            return
        text, entries = _("{task}, {day}"), list[tuple[str, str]]()
        for number, record in ((number, result.record) for number, result in results):
            day, task = record.started_utc[:16].replace("T", " "), task_title(record.task)
            task = f"{number}: {task}" if number else task
            entries.insert(0, (text.format(task=task, day=day), record.trial_id))
        wanted = self._newTrial or chosenData(self._ui.trialComboBox)
        self._newTrial = ""
        offerEntries(self._ui.trialComboBox, entries, wanted)
        self._showTrial()

    def _showTrial(self, _index: int = 0) -> None:
        ui, cohort, trialId = self._ui, self._session.cohort, chosenData(self._ui.trialComboBox)
        self._session.replay.retryFeedback()
        try:
            study, results = self._trainees.study, self._trainees.results()
            found = {result.record.trial_id: result for _number, result in results}
            result = found.get(trialId)
            self._trial = trial = result if isinstance(result, StoredTrial) else None
            self._drill = drill = result if isinstance(result, DrillRecord) else None
            beside = [] if trial is None else standings(study, trial, cohort)
        except InputError as error:
            self._named = None
            self._showMessage(str(error))
            return
        scores, ctps, motion = [], [], []
        if trial is not None:
            scores, ctps, motion = scoreRows(trial), ctpsRows(trial, cohort), motionRows(trial)
        elif drill is not None:
            scores = drillRows(drill)
        rows = ((row.title, row.text, row.note) for row in scores)
        fillTable(ui.scoreTable, rows, [row.tip for row in scores])
        for table, parts in ((ui.ctpsTable, ctps), (ui.motionTable, motion)):
            fillTable(table, [(row.title, row.text) for row in parts], [row.note for row in parts])
        setText(ui.ctpsText, CTPS_WARNING if ctps else "")
        fillTable(ui.standingsTable, map(_comparisonRow, beside))
        # Once for each trial, so that messages about an export or a report stay.
        if trialId != self._named:
            self._named = trialId
            self._showMessage(_title(None if result is None else result.record))
        self._showFeedback()

    def _showFeedback(self) -> None:
        trial, self._worst = self._trial, ""
        sentences = [] if trial is None else [_("Feedback on the trial is being prepared.")]
        if self._drill is not None:
            sentences = [
                f"{row.title}: {row.text}, {row.note}." for row in drillRows(self._drill)[:5]
            ]
        try:
            feedback = None if trial is None else self._session.replay.feedback(trial)
        except InputError as error:
            sentences = [str(error)]
        else:
            if feedback is not None:
                # The score is one paragraph: the whole panel fits a laptop's screen.
                parts = len(feedback.score_sentences)
                score, others = feedback.sentences[:parts], feedback.sentences[parts:]
                sentences = [*filter(None, [" ".join(score)]), *others]
                self._worst = feedback.worst.label
        setText(self._ui.feedbackText, "\n".join(sentences))
        self._showUsable()

    def _showUsable(self) -> None:
        ui, isAtWork = self._ui, self._work.isUnderWay
        hasTrial = self._trial is not None
        reason = _("Choose a trial first.")
        busy = _("Wait until the current work is done.")
        setEnabled(ui.showTablesButton, hasTrial or self._drill is not None, reason)
        setEnabled(ui.replayButton, hasTrial or isAtWork, reason)
        setEnabled(ui.exportScoresButton, not isAtWork, busy)
        setEnabled(ui.reportButton, not isAtWork, busy)
        if hasTrial:
            reason = _("The trial cannot be analyzed.")
        tip = _("Show how point {label} was touched.").format(label=self._worst)
        isUsable = bool(self._worst) and not isAtWork
        setEnabled(ui.worstTouchButton, isUsable, busy if isAtWork else reason, tip)
        self._showReplay()


def _comparisonRow(found: GroupComparison) -> tuple[str, ...]:
    title = f"{found.title} ({found.unit})" if found.unit else found.title
    group = found.group, str(found.count), fixed(found.median, 2)
    return title, fixed(found.value, 2), *group, f"{100 * found.betterThan:.0f} %"


def _title(record: TrialRecord | DrillRecord | None) -> str:
    if record is None:
        return _("Choose a trainee with a scored trial.")
    task, mode = task_title(record.task), short_mode_title(record.mode)
    return _("{trainee}, {task}, {mode}").format(trainee=record.trainee, task=task, mode=mode)
