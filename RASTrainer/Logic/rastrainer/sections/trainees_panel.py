"""The section Trainees: create, choose, archive, export and delete them, and show their trials."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import slicer

from rastrainer.decision.drill_record import DrillRecord
from rastrainer.decision.drill_score import drill_score
from rastrainer.errors import InputError
from rastrainer.number_text import fixed
from rastrainer.protocol import TRIAL_RUN, Mode
from rastrainer.sections.application import CALIBRATION, CURVE, askWhereToSave, showChart
from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, connectClick
from rastrainer.sections.trainees_logic import calibration
from rastrainer.slicer.scene.tables import showCalibration, showLearningCurve
from rastrainer.slicer.settings import STUDY, STUDY_ADDRESS, Setting
from rastrainer.slicer.translation import _
from rastrainer.study.database.database import EXAMPLE, study_place
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import StoredTrial, Trainee, day_of
from rastrainer.study.outcomes import short_mode_title, task_title
from rastrainer.trial.record import AbortedTrial
from rastrainer.widgets.controls import (
    CancelableWork,
    chosenData,
    connectAsPressed,
    fillComboBox,
    fillTable,
    numberOrDash,
    setEnabled,
    setSilently,
    setText,
)
from rastrainer.widgets.plain_text import toolTip
from rastrainer.widgets.shown_errors import showErrors


class TraineesPanel(Panel):
    """The section Trainees."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._logic = session.trainees
        self._trainee: Trainee | None = None
        self._isStateShown = self._isErasing = False
        failure = _("The trainee was not deleted.")
        shows = (self._showMessage, self._showDeleting, self._noteErasing)
        self._deletion = CancelableWork(ui.deleteTraineeButton, self.deleteTrainee, failure, *shows)
        self._showPlace()
        ui.studyPathLineEdit.connect("currentPathChanged(QString)", self.chooseStudy)
        ui.studyAddressLineEdit.connect("editingFinished()", self.chooseStudyAddress)
        ui.traineeComboBox.connect(
            "activated(int)", lambda _index: self._logic.choose(chosenData(ui.traineeComboBox))
        )
        ui.archivedCheckBox.connect("toggled(bool)", self._show)
        ui.consentCheckBox.connect("toggled(bool)", self.setConsent)
        ui.createTraineeButton.connect("clicked()", self.createTrainee)
        connectAsPressed(
            ui.archiveButton,
            lambda: partial(self.setArchived, not (self._trainee and self._trainee.archived)),
        )
        failure = _("The trainee was not exported.")
        connectClick(ui.exportTraineeButton, self.exportTrainee, failure)
        connectClick(ui.exportHistoryButton, self.exportHistory, _("The history was not exported."))
        section, failure = ui.traineesCollapsibleButton, _("The learning curve cannot be shown.")
        self.borrowLayout(ui.learningCurveButton, section, CURVE, self._plotCurve, failure)
        plot, failure = self._plotCalibration, _("The target errors cannot be shown.")
        self.borrowLayout(ui.calibrationButton, section, CALIBRATION, plot, failure)
        self.listen((self._logic.changed, self._show))
        self._show()

    def chooseStudy(self, path: str) -> None:
        """Continue with the study of another file, once its name is complete."""
        isFile, file = isinstance(self._session.studyPlace, Path), Path(path)
        if not isFile or file == self._session.studyFile:
            return
        if not path.endswith(".db"):
            self._showNoStudy(file)
            return
        question = _("There is no folder {folder}. Make it, for a new study?")
        text, title = toolTip(question.format(folder=file.parent)), _("Choose a study")
        if file.parent.is_dir() or slicer.util.confirmYesNoDisplay(text, title):
            self._openStudy(file, STUDY, path)
        else:
            self._showPlace()

    def _showNoStudy(self, path: Path) -> None:
        """Say why a path is no study, unless the user may still be typing it."""
        sentence = ""
        if path.is_dir():
            sentence = _(
                "{path} is a folder: choose the file of a study in it, or enter the name of a new "
                "one, such as {example}. Until then, {study} stays open."
            )
        elif path.is_file():
            sentence = _(
                "{path} is no study, whose name ends with .db. Until one is chosen, {study} stays "
                "open."
            )
        names = {"path": path, "example": path / "study.db", "study": self._session.studyFile}
        self._showMessage(sentence.format(**names), isState=True)

    def chooseStudyAddress(self) -> None:
        address = self._ui.studyAddressLineEdit.text.strip()
        self._openStudy(address or self._session.studyFile, STUDY_ADDRESS, address)

    def _openStudy(self, where: str | Path, setting: Setting[str], chosen: str) -> None:
        with showErrors(_("The study cannot be used.")):
            try:
                place = study_place(where)
                if setting is STUDY_ADDRESS and chosen and isinstance(place, Path):
                    raise InputError(_("An address looks like {text}.").format(text=EXAMPLE))
                if place == self._session.studyPlace:
                    return
                self._session.chooseStudy(place)
            finally:
                self._showPlace()
            self._session.settings.set(setting, chosen)

    def _showPlace(self) -> None:
        ui, place = self._ui, self._session.studyPlace
        ui.studyAddressLineEdit.text = "" if isinstance(place, Path) else str(place)
        ui.studyPathLineEdit.currentPath = str(self._session.studyFile)

    def createTrainee(self) -> None:
        ui = self._ui
        with showErrors(_("The trainee was not created.")):
            self._logic.create(ui.pseudonymLineEdit.text, ui.newConsentCheckBox.checked)
            ui.pseudonymLineEdit.text = ""
            ui.newConsentCheckBox.checked = False

    def setConsent(self, consent: bool) -> None:
        with showErrors(_("The consent was not saved.")):
            try:
                self._logic.change(consent=consent)
            except InputError:
                setSilently(self._ui.consentCheckBox, "checked", not consent)
                raise

    def setArchived(self, isArchived: bool) -> None:
        """Archive the chosen trainee, who stays in view, or bring them back."""
        failed = _("The trainee was not archived.")
        with showErrors(failed if isArchived else _("The trainee was not restored.")):
            if isArchived:
                self._ui.archivedCheckBox.checked = True
            self._logic.change(archived=isArchived)

    def exportTrainee(self) -> None:
        from rastrainer.study.trainee_data import export_trainee

        self._export(_("Export the trainee"), "JSON", export_trainee)

    def exportHistory(self) -> None:
        """Write the trials of the chosen trainee as a table, and aborted trials as another."""
        from rastrainer.study.tidy_csv import write_history

        self._export(
            _("Export the history"),
            "CSV",
            lambda study, name, path: write_history(study, [name], path),
        )

    def _export(self, caption: str, kind: str, write: Callable[[Study, str, Path], int]) -> None:
        chosen, suffix = self._logic.chosen, kind.lower()
        path = askWhereToSave(caption, f"{chosen}.{suffix}", f"{kind} (*.{suffix})")
        if path is not None:
            count = write(self._logic.study, chosen, path)
            text = _("{count} trials were written to {path}.")
            self._showMessage(text.format(count=count, path=path))

    def deleteTrainee(self) -> None:
        name, results = self._logic.chosen, self._logic.results()
        trials = sum(isinstance(result, StoredTrial) for _number, result in results)
        question = _(
            "Delete {name} with {trials} trials and {drills} drills from the study and from the "
            "journals on this computer, permanently? This cannot be undone; export the trainee "
            "first if the data may be needed. Earlier exports and backups are yours to delete."
        ).format(name=name, trials=trials, drills=len(results) - trials)
        if slicer.util.confirmYesNoDisplay(toolTip(question), _("Delete the trainee")):
            erased = self._deletion.run(self._logic.delete)
            if erased is None:
                return
            text = _("{name} was deleted with {trials} trials and {journals} journals.").format(
                name=name, trials=erased.trials, journals=erased.journals
            )
            self._showMessage(" ".join((text, *erased.warnings)))

    def _noteErasing(self, step: str, _share: float) -> None:
        """Show that the deletion has begun, which nothing can undo."""
        if step and not self._isErasing:
            self._isErasing = True
            self._showMessage(step)
            self._showDeleting()

    def _showDeleting(self) -> None:
        ui, isAtWork = self._ui, self._deletion.isUnderWay
        self._isErasing = self._isErasing and isAtWork
        # Nobody else is chosen meanwhile. A file is chosen only if no address is.
        for widget in (ui.studyAddressLineEdit, ui.traineeComboBox):
            widget.enabled = not isAtWork
        isFile = isinstance(self._session.studyPlace, Path)
        ui.studyPathLineEdit.enabled = isFile and not isAtWork
        if isAtWork:
            tip = _("Delete nothing; the study is still being opened.")
            begun = _("The deletion has begun, and can no longer be canceled.")
            setEnabled(ui.deleteTraineeButton, not self._isErasing, begun, tip)
        else:
            reason = _("Choose a trainee first.")
            setEnabled(ui.deleteTraineeButton, self._trainee is not None, reason)

    def _plotCurve(self) -> None:
        chart = showLearningCurve(slicer.mrmlScene, self._logic.chosen, self._logic.history())
        showChart(self._session.layout, chart)

    def _plotCalibration(self) -> None:
        """Plot true over expected TRE of all trials of the study."""
        found = self._logic.inStudy(calibration)
        self._showMessage(" ".join(found.sentences()))
        showChart(self._session.layout, showCalibration(slicer.mrmlScene, found), CALIBRATION)

    def _show(self, *_arguments: Any) -> None:
        ui = self._ui
        try:
            trainees = self._logic.trainees(archived=ui.archivedCheckBox.checked)
            trainee, results = self._logic.chosenTrainee(), self._logic.results()
            aborted = () if trainee is None else self._logic.study.aborted(trainee.pseudonym)
        except InputError as error:
            self._showMessage(str(error), isState=True)
            return
        self._trainee = trainee
        archived = _("{name} (archived)")
        entries = [(_("Choose a trainee"), "")]
        for each in trainees:
            title = archived if each.archived else "{name}"
            entries.append((title.format(name=each.pseudonym), each.pseudonym))
        ui.pseudonymLineEdit.placeholderText = self._logic.study.next_pseudonym()
        fillComboBox(ui.traineeComboBox, entries, trainee.pseudonym if trainee else "")
        setSilently(ui.consentCheckBox, "checked", trainee is not None and trainee.consent)
        self._showDeleting()
        ui.consentCheckBox.enabled = trainee is not None
        isArchived = trainee is not None and trainee.archived
        ui.archiveButton.text = _("Bring back") if isArchived else _("Archive")
        nobody = _("Choose a trainee first.")
        for button in (ui.archiveButton, ui.exportTraineeButton):
            setEnabled(button, trainee is not None, nobody)
        nothing = nobody if trainee is None else _("The trainee has no trials yet.")
        count = sum(isinstance(result, StoredTrial) for _number, result in results)
        for button in (ui.learningCurveButton, ui.exportHistoryButton):
            setEnabled(button, bool(count), nothing)
        if trainee is not None:
            name, day = trainee.pseudonym, day_of(trainee.created_utc)
            text = _("{name}, since {day}. Trials: {count}, drills: {drills}. {aborted}")
            drills = len(results) - count
            text = text.format(
                name=name, day=day, count=count, drills=drills, aborted=_aborted(aborted)
            )
            self._showMessage(text, isState=True)
        elif self._isStateShown or not ui.traineeText.text:
            text = _("Choose who is training, or create a new trainee.")
            self._showMessage(text, isState=True)
        tips = [result.record.started_utc for _number, result in results]
        fillTable(ui.historyTable, [_historyRow(*each) for each in results], tips)

    def _showMessage(self, sentence: str, isState: bool = False) -> None:
        """Show a sentence; one about the present state, until there is another state."""
        self._isStateShown = isState
        setText(self._ui.traineeText, sentence.rstrip())


def _aborted(aborted: Sequence[AbortedTrial]) -> str:
    """Return how many trials were aborted, trial runs counted separately; "" for none."""
    records = [record for record in aborted if record.task != TRIAL_RUN]
    runs = len(aborted) - len(records)
    if not aborted:
        return ""
    return _(
        "Aborted: {count}, of them {late} after all touches; trial runs ended early: {runs}."
    ).format(count=len(records), late=sum(r.is_after_all_touches for r in records), runs=runs)


def _historyRow(number: str, result: StoredTrial | DrillRecord) -> tuple[str, ...]:
    record = result.record
    task, start = task_title(record.task), record.started_utc[5:16].replace("T", " ")
    if record.mode != Mode.DESKTOP.value:
        task = f"{task}, {short_mode_title(record.mode)}"
    if isinstance(result, DrillRecord):
        score, seconds = drill_score(result.cases), sum(case.time_s for case in result.cases)
        # In two lines: the columns after it stay in view.
        text = _("{task}: d′ {sensitivity}\nharmful {harmful}, vain {vain}")
        sensitivity = fixed(score.sensitivity.value, 1)
        task = text.format(
            task=task, sensitivity=sensitivity, harmful=score.harmful, vain=score.vain
        )
        return number, start, task, f"{seconds:.1f}", "–", fixed(score.score, 1)
    return (
        number,
        start,
        task,
        f"{result.record.completion_time_s:.1f}",
        numberOrDash(result.true_tre_mm, 2),
        numberOrDash(None if result.score is None else result.score.score, 1),
    )
