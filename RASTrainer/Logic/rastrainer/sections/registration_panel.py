"""The section Registration: three fits side by side, residuals, target error, and remedies."""

from __future__ import annotations

from functools import partial
from typing import Any

import qt

from rastrainer.registration.fits import AFFINE, RIGID, SIMILARITY
from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, connectClick
from rastrainer.sections.registration_logic import Comparison
from rastrainer.slicer.scene.registration_input import Remedy
from rastrainer.slicer.scene.trial_scene import isApplied, setApplied
from rastrainer.slicer.settings import FIT, IS_HEAD_COLORED
from rastrainer.slicer.translation import _
from rastrainer.widgets.controls import (
    bind,
    bindChosen,
    blockedSignals,
    chosenData,
    fillTable,
    numberOrDash,
    setEnabled,
    setSilently,
    setText,
    textLabel,
)
from rastrainer.widgets.plain_text import buttonTitle

TITLES = {RIGID: _("Rigid"), SIMILARITY: _("Similarity"), AFFINE: _("Affine")}


class RegistrationPanel(Panel):
    """The section Registration."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._logic = session.registration
        self._remedies: tuple[Remedy, ...] = ()
        self._remedyWidgets: list[Any] = []
        self._labels: tuple[str, ...] = ()
        entries = [(title, kind) for kind, title in TITLES.items()]
        bindChosen(ui.kindComboBox, entries, session.settings, FIT)
        self._logic.kind = chosenData(ui.kindComboBox)
        choose = self._logic.chooseKind
        ui.kindComboBox.connect("activated(int)", lambda _row: choose(chosenData(ui.kindComboBox)))
        for combo in (ui.movingComboBox, ui.fixedComboBox, ui.targetComboBox):
            combo.connect("currentNodeChanged(vtkMRMLNode*)", self._chooseLists)
        ui.residualsTable.connect("itemSelectionChanged()", self._chooseFiducial)
        connectClick(ui.excludeButton, self.excludeChosen, _("The fiducial was not left out."))
        connectClick(ui.fleButton, self.localizeChosen, _("The localization error was not set."))
        connectClick(ui.undoButton, self._logic.undo, _("Nothing was undone."))
        ui.appliedCheckBox.connect("toggled(bool)", self._apply)
        ui.headColoredCheckBox.connect("toggled(bool)", self._logic.setHeadColored)
        bind(ui.headColoredCheckBox, "checked", session.settings, IS_HEAD_COLORED)
        self.listen((self._logic.changed, self._show), (session.sceneChanged, self._showApplied))
        self._show()

    def excludeChosen(self) -> None:
        if self._chosen() >= 0:
            self._logic.change(self._logic.choices.without((self._labels[self._chosen()],)))

    def localizeChosen(self) -> None:
        if self._chosen() >= 0:
            label, fleMm = self._labels[self._chosen()], self._ui.fleSpinBox.value
            self._logic.change(self._logic.choices.localized(label, fleMm))

    def _chosen(self) -> int:
        """Return the chosen row of the residuals; -1 where none is."""
        row = self._ui.residualsTable.currentRow()
        return row if row < len(self._labels) else -1

    def _showApplied(self) -> None:
        box, transform = self._ui.appliedCheckBox, self._logic.transform
        setSilently(box, "checked", transform is not None and isApplied(transform))
        box.enabled = transform is not None

    def _chooseLists(self, _node: Any = None) -> None:
        ui = self._ui
        combos = (ui.movingComboBox, ui.fixedComboBox, ui.targetComboBox)
        self._logic.chooseLists(*(combo.currentNode() for combo in combos))
        self._session.woken.emit()

    def _apply(self, applied: bool) -> None:
        transform = self._logic.transform
        if transform is not None:
            setApplied(transform, applied)

    def _chooseFiducial(self) -> None:
        comparison, row = self._logic.comparison, self._chosen()
        if comparison is not None and row >= 0:
            self._session.slices.show(comparison.shown.fixed_mm[row])
        self._showButtons()

    def _show(self) -> None:
        ui, comparison = self._ui, self._logic.comparison
        setText(ui.registrationText, _summary(comparison) if comparison else self._logic.problem)
        setText(ui.treText, _treText(comparison) if comparison else "", INTERVAL_NOTE)
        fits = _fitRows(comparison) if comparison else []
        fillTable(ui.fitsTable, fits, [INTERVAL_NOTE] * len(fits))
        table, row = self._ui.residualsTable, self._chosen()
        chosen = self._labels[row] if row >= 0 else ""
        rows: list[tuple[str, ...]] = []
        self._labels = () if comparison is None else comparison.shown.labels
        if comparison is not None:
            shown, sizes = comparison.shown, self._logic.choices.fle
            without = comparison.leaveOneOut.get(shown.kind, [None] * len(self._labels))
            for label, *lengths in zip(self._labels, shown.residuals_mm, without, strict=True):
                lengths.append(sizes.get(label))
                rows.append((label, *(numberOrDash(each, 2) for each in lengths)))
        with blockedSignals(table):
            fillTable(table, rows)
            newRow = self._labels.index(chosen) if chosen in self._labels else -1
            if newRow != row:
                table.clearSelection()
                table.setCurrentCell(newRow, 0 if newRow >= 0 else -1)
        self._showRemedies(comparison.remedies if comparison else ())
        self._showButtons()
        self._showApplied()

    def _showButtons(self) -> None:
        ui = self._ui
        for button in (ui.excludeButton, ui.fleButton):
            setEnabled(button, self._chosen() >= 0, _("Choose a row of the table first."))
        setEnabled(ui.undoButton, self._logic.canUndo, _("No pair was changed."))

    def _showRemedies(self, remedies: tuple[Remedy, ...]) -> None:
        """Show each warning with its button, in place of those before, unless they are the same.

        Otherwise a button could be replaced between press and release, and the press would be lost.
        """
        if remedies == self._remedies:
            return
        self._remedies, layout = remedies, self._ui.warningsWidget.layout()
        for widget in self._remedyWidgets:
            layout.removeWidget(widget)
            widget.setParent(None)
            widget.deleteLater()
        self._remedyWidgets = []
        for number, remedy in enumerate(remedies):
            text = textLabel("⚠ " + remedy.warning.message)
            text.setObjectName(f"warning{number}Text")
            self._remedyWidgets.append(text)
            if remedy.title:
                button = qt.QPushButton(buttonTitle(remedy.title))
                button.setObjectName(f"remedy{number}Button")
                button.minimumWidth = 1
                button.toolTip = _("Apply this change and register again. Undo reverts it.")
                change = partial(self._logic.change, remedy.choices)
                connectClick(button, change, _("The pairs were not changed."))
                self._remedyWidgets.append(button)
        for widget in self._remedyWidgets:
            layout.addWidget(widget)


def _summary(comparison: Comparison) -> str:
    pairs = comparison.pairs
    said = [_("{count} pairs are registered.").format(count=len(pairs.labels))]
    if pairs.missing:
        said.append(_("Not touched yet: {labels}.").format(labels=", ".join(pairs.missing)))
    if pairs.excluded:
        leftOut = _("Left out: {labels}; the score of the trial still uses all pairs.")
        said.append(leftOut.format(labels=", ".join(pairs.excluded)))
    if comparison.fits[RIGID].weights is not None:
        said.append(
            _("The rigid fit is weighted by the stated FLE; the score of the trial is not.")
        )
    return " ".join(said)


def _treText(comparison: Comparison) -> str:
    error = comparison.errors.get(RIGID)
    if error is None:
        return _("Place or choose a target to see the expected error there.")
    low, high = error.interval_mm
    return _(
        "Expected TRE at the target, rigid: {expected:.2f} mm (95 %: {low:.2f} to {high:.2f} mm). "
        "A small FRE does not guarantee a small TRE."
    ).format(expected=error.expected_mm, low=low, high=high)


def _fitRows(comparison: Comparison) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for kind, title in TITLES.items():
        fit, error = comparison.fits.get(kind), comparison.errors.get(kind)
        interval = "–" if error is None else "{:.2f}–{:.2f}".format(*error.interval_mm)
        fre, largest = (None, None) if fit is None else (fit.fre_mm, fit.residuals_mm.max())
        lengths = fre, largest, None if error is None else error.expected_mm
        rows.append((title, *(numberOrDash(each, 2) for each in lengths), interval))
    return rows
