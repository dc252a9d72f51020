"""The section Plan of a procedure: its lines, their checks, and a scenario that has it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import slicer

from rastrainer.procedure.checks import LineMeasures, MeasuredProcedure
from rastrainer.procedure.plan import ProcedureKind
from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, chosenScenario, connectClick
from rastrainer.sections.procedure_plan_logic import Plan, checkPlan, editPlan, planFile, readPlan
from rastrainer.slicer.scene.nodes import Role, worldPoints
from rastrainer.slicer.scene.plan_points import startPlacing, unfinishedLine
from rastrainer.slicer.scene.procedure_lines import (
    instrumentOf,
    isNoGo,
    lengthMm,
    noGoNodes,
    placeLine,
    planLines,
    setInstrument,
    setNoGo,
)
from rastrainer.slicer.translation import _
from rastrainer.widgets.controls import (
    CancelableWork,
    blockedSignals,
    chosenData,
    fillComboBox,
    fillTable,
    numberOrDash,
    offerEntries,
    setEnabled,
    setProperty,
    setSilently,
    setText,
    showPercent,
)

KINDS = (
    (_("Biopsy"), ProcedureKind.BIOPSY.value),
    (_("Deep brain stimulation (DBS)"), ProcedureKind.DBS.value),
    (_("Stereo-EEG (SEEG)"), ProcedureKind.SEEG.value),
)
REACH = {True: _("yes"), False: _("no"), None: "–"}


class ProcedurePlanPanel(Panel):
    """The section Plan of a procedure."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._name = ""
        self._checked: tuple[tuple, MeasuredProcedure] | None = None
        self._problem = ""
        self._removed: list[tuple[Any, int]] = []
        failure = _("The lines were not checked.")
        note = partial(setattr, self, "_problem")
        shows = (note, self.showState, partial(showPercent, ui.procedurePlanText))
        self._work = CancelableWork(ui.checkLinesButton, self.check, failure, *shows)
        fillComboBox(ui.procedureKindComboBox, KINDS, ProcedureKind.BIOPSY.value)
        connectClick(ui.editProcedureButton, self.edit, _("The procedure cannot be edited."))
        connectClick(ui.placeLineButton, self.placeLine, _("No line can be placed."))
        ui.removeLineButton.connect("clicked()", self.removeLine)
        restore = ui.restoreLineButton
        restore.connect("clicked()", lambda: placeLine(slicer.mrmlScene, *self._removed.pop()))
        ui.raiseLineButton.connect("clicked()", self.raiseLine)
        ui.noGoButton.connect("clicked()", self.toggleNoGo)
        for button in (ui.removeLineButton, restore, ui.raiseLineButton, ui.noGoButton):
            button.connect("clicked()", self.showState)
        noPoint = _("No checkpoint can be placed.")
        connectClick(ui.placeCheckpointButton, self.placeCheckpoint, noPoint)
        ui.linesTable.connect("itemSelectionChanged()", self._showLine)
        ui.lineNameLineEdit.connect("editingFinished()", self._renameLine)
        for box in (ui.lineDiameterSpinBox, ui.lineSafetySpinBox):
            box.connect("valueChanged(double)", self._changeInstrument)
        ui.noGoComboBox.connect("currentNodeChanged(vtkMRMLNode*)", self.showState)
        connectClick(ui.saveProcedureButton, self.save, _("The procedure was not saved."))
        self.listen((session.taskChosen, self._showProcedures))
        section = ui.procedurePlanCollapsibleButton
        self.showWhileOpen(section, self.showState, session.sceneChanged)
        self._showProcedures()

    def edit(self) -> None:
        """Load the chosen procedure into the scene, in place of the plan there."""
        ui = self._ui
        scenario = chosenScenario(ui, self._session)
        procedure = editPlan(slicer.mrmlScene, scenario, chosenData(ui.procedurePlanComboBox))
        self._checked, self._problem, self._removed = None, "", []
        self._name = "" if procedure is None else procedure.name
        if procedure is not None:
            ui.procedureTitleLineEdit.text = procedure.title
            ui.procedureSourceLineEdit.text = procedure.source
            ui.procedureSourceLineEdit.cursorPosition = 0
            fillComboBox(ui.procedureKindComboBox, KINDS, procedure.kind.value)
        ui.checkpointsComboBox.setCurrentNode(Role.CHECKPOINTS.find(slicer.mrmlScene))
        self.showState()

    def placeLine(self) -> None:
        """Let the next two clicks place a line, from its entry to its target."""
        startPlacing(slicer.mrmlScene, unfinishedLine(slicer.mrmlScene, Role.PLAN_LINE))
        self.showState()

    def removeLine(self) -> None:
        line = self._line()
        if line is not None:
            self._removed.append((line, self._ui.linesTable.currentRow()))
            slicer.mrmlScene.RemoveNode(line)

    def raiseLine(self) -> None:
        """Move the chosen line up in the order of the procedure; it stays chosen."""
        line, table = self._line(), self._ui.linesTable
        if line is not None:
            place = max(table.currentRow() - 1, 0)
            placeLine(slicer.mrmlScene, line, place)
            table.selectRow(place)

    def placeCheckpoint(self) -> None:
        """Let the next click place a checkpoint, in the chosen list or in the plan's own."""
        chosen = self._ui.checkpointsComboBox
        node = chosen.currentNode() or Role.CHECKPOINTS.make(slicer.mrmlScene)
        chosen.setCurrentNode(node)
        startPlacing(slicer.mrmlScene, node)

    def toggleNoGo(self) -> None:
        node = self._ui.noGoComboBox.currentNode()
        if node is not None:
            setNoGo(node, not isNoGo(node))

    def check(self) -> None:
        self._problem = ""
        scenario = chosenScenario(self._ui, self._session)
        plan, snapshot = self._read(), self._snapshot()
        found = self._work.run(partial(checkPlan, self._session.scenarioFiles, scenario, plan))
        if found is not None:
            self._checked = snapshot, found
            self.showState()

    def save(self) -> None:
        with planFile(*self._read()) as path:
            title = self._ui.procedureScenarioLineEdit.text
            self.saveCopy(self._work, title, ["--procedure", str(path)])

    def showState(self, *_arguments: Any) -> None:
        ui, isAtWork = self._ui, self._work.isUnderWay
        isFresh = self._checked is not None and self._checked[0] == self._snapshot()
        self._showLines(self._checked[1].lines if isFresh and self._checked else ())
        hasLines, line = bool(planLines(slicer.mrmlScene)), self._line()
        for box in (ui.lineNameLineEdit, ui.lineDiameterSpinBox, ui.lineSafetySpinBox):
            box.enabled = line is not None
        setEnabled(ui.removeLineButton, line is not None, _("Choose a line in the table first."))
        setEnabled(ui.restoreLineButton, bool(self._removed), _("No line has been removed."))
        isBelow = line is not None and ui.linesTable.currentRow() > 0
        first = _("Choose a line below the first one in the table.")
        setEnabled(ui.raiseLineButton, isBelow, first)
        node = ui.noGoComboBox.currentNode()
        isKept = node is not None and isNoGo(node)
        setProperty(ui.noGoButton, "text", _("Ignore") if isKept else _("Keep away"))
        setEnabled(ui.noGoButton, node is not None, _("Choose a model or a segmentation first."))
        names = ", ".join(each.GetName() for each in noGoNodes(slicer.mrmlScene))
        setText(ui.noGoText, _("To keep away from: {names}").format(names=names or "–"))
        first = _("Place a line first.")
        setEnabled(ui.checkLinesButton, hasLines or isAtWork, first)
        reason = _("Wait until the current work is done.") if isAtWork else first
        setEnabled(ui.saveProcedureButton, hasLines and not isAtWork, reason)
        if not isAtWork:
            setText(ui.procedurePlanText, self._problem or self._verdict(isFresh))

    def _verdict(self, isFresh: bool) -> str:
        """Return the errors found by the last check of the plan, or that there are none."""
        if self._checked is None:
            return ""
        if not isFresh:
            return _("The plan has changed since it was checked: check it again.")
        wrong = self._checked[1].wrong
        return "\n".join(wrong) or _("The procedure can be carried out.")

    def _snapshot(self) -> tuple:
        """Return a value that changes whenever a measured input changes."""
        lines = planLines(slicer.mrmlScene)
        named = [(line.GetName(), instrumentOf(line)) for line in lines]
        placed = [(worldPoints(line).tobytes(), lengthMm(line)) for line in lines]
        structures = [(node.GetID(), node.GetMTime()) for node in noGoNodes(slicer.mrmlScene)]
        return named, placed, structures, chosenData(self._ui.scenarioComboBox)

    def _showLines(self, found: Sequence[LineMeasures]) -> None:
        lines, table = planLines(slicer.mrmlScene), self._ui.linesTable
        measured = {each.name: each for each in found}
        chosen = table.currentRow()
        with blockedSignals(table):
            if fillTable(table, [_row(line, measured.get(line.GetName())) for line in lines]):
                if lines:
                    table.selectRow(min(max(chosen, 0), len(lines) - 1))
                self._showLine()

    def _showLine(self) -> None:
        ui, line = self._ui, self._line()
        if line is not None:
            diameter, safety = instrumentOf(line)
            setSilently(ui.lineDiameterSpinBox, "value", diameter)
            setSilently(ui.lineSafetySpinBox, "value", safety)
            setProperty(ui.lineNameLineEdit, "text", line.GetName())

    def _renameLine(self) -> None:
        line, name = self._line(), self._ui.lineNameLineEdit.text.strip()
        if line is not None and name:
            line.SetName(name)
            self.showState()

    def _changeInstrument(self, _value: float = 0.0) -> None:
        ui, line = self._ui, self._line()
        if line is not None:
            setInstrument(line, ui.lineDiameterSpinBox.value, ui.lineSafetySpinBox.value)
            self.showState()

    def _line(self) -> Any | None:
        lines, row = planLines(slicer.mrmlScene), self._ui.linesTable.currentRow()
        return lines[row] if 0 <= row < len(lines) else None

    def _read(self) -> Plan:
        ui, kind = self._ui, chosenData(self._ui.procedureKindComboBox)
        title, source = ui.procedureTitleLineEdit.text, ui.procedureSourceLineEdit.text
        checkpoints = ui.checkpointsComboBox.currentNode()
        return readPlan(slicer.mrmlScene, title, kind, source, self._name, checkpoints)

    def _showProcedures(self) -> None:
        entries = [(title, name) for name, title in self._session.procedures]
        entries.append((_("New procedure"), ""))
        combo = self._ui.procedurePlanComboBox
        offerEntries(combo, entries, *([chosenData(combo)] if combo.count else []))
        self.showState()


def _row(line: Any, measured: LineMeasures | None) -> tuple[str, ...]:
    first = (line.GetName(), numberOrDash(lengthMm(line), 1))
    if measured is None:
        return (*first, "–", "–", "–", "–")
    nearest = measured.nearest_no_go
    return (
        *first,
        numberOrDash(measured.skull_angle_deg, 1),
        numberOrDash(measured.no_go_mm.get(nearest), 1, nearest),
        numberOrDash(measured.nearest_line_mm, 1, measured.nearest_line),
        REACH[measured.is_held],
    )
