"""The section Registration: three fits side by side, residuals, target error, and remedies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import qt

from rastrainer.panels.panel import Panel, connectClick
from rastrainer.panels.plain_text import buttonTitle
from rastrainer.panels.shown_errors import showErrors
from rastrainer.panels.widgets import (
    bind,
    bindChosen,
    chosenData,
    fillTable,
    setChecked,
    setEnabled,
    setText,
    textLabel,
)
from rastrainer.registration.fits import AFFINE, RIGID, SIMILARITY
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.slicer.logic.module_session import ModuleSession
from rastrainer.slicer.logic.registration_comparison import Comparison
from rastrainer.slicer.scene.registration_input import Remedy
from rastrainer.slicer.scene.trial_scene import isApplied, setApplied
from rastrainer.slicer.settings import FIT, IS_HEAD_COLORED
from rastrainer.slicer.translation import _

TITLES = {RIGID: _("Rigid"), SIMILARITY: _("Similarity"), AFFINE: _("Affine")}


class RegistrationPanel(Panel):
    """The section Registration."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._logic = session.registration
        self._slices = session.slices
        self._remedies: tuple[Remedy, ...] = ()
        self._remedyWidgets: list[Any] = []
        self._labels: tuple[str, ...] = ()
        entries = [(title, kind) for kind, title in TITLES.items()]
        bindChosen(ui.kindComboBox, entries, session.settings, FIT)
        self._logic.kind = chosenData(ui.kindComboBox)
        ui.kindComboBox.connect("activated(int)", self._chooseKind)
        for combo in (ui.movingComboBox, ui.fixedComboBox):
            combo.connect("currentNodeChanged(vtkMRMLNode*)", self._chooseLists)
        ui.targetComboBox.connect("currentNodeChanged(vtkMRMLNode*)", self._chooseTarget)
        ui.residualsTable.connect("itemSelectionChanged()", self._chooseFiducial)
        connectClick(ui.excludeButton, self.excludeChosen, _("The fiducial was not left out."))
        connectClick(ui.fleButton, self.localizeChosen, _("The localization error was not set."))
        connectClick(ui.undoButton, lambda: self._logic.undo(), _("Nothing was undone."))
        ui.appliedCheckBox.connect("toggled(bool)", self._apply)
        ui.headColoredCheckBox.connect("toggled(bool)", self._logic.setHeadColored)
        bind(ui.headColoredCheckBox, "checked", session.settings, IS_HEAD_COLORED)
        self._woken = session.woken
        self.listen((self._logic.changed, self._show), (session.sceneChanged, self._showApplied))
        self._show()

    def excludeChosen(self) -> None:
        """Register again without the chosen fiducial."""
        row = self._ui.residualsTable.currentRow()
        if row >= 0 and self._logic.shown is not None:
            self._logic.exclude(self._logic.shown.labels[row])

    def localizeChosen(self) -> None:
        """Register again with the stated localization error of the chosen fiducial."""
        row = self._ui.residualsTable.currentRow()
        if row >= 0 and self._logic.shown is not None:
            self._logic.localize(self._logic.shown.labels[row], self._ui.fleSpinBox.value)

    def _showApplied(self) -> None:
        transform = self._logic.transform()
        setChecked(self._ui.appliedCheckBox, transform is not None and isApplied(transform))
        self._ui.appliedCheckBox.enabled = transform is not None

    def _chooseLists(self, _node: Any = None) -> None:
        ui = self._ui
        self._logic.chooseLists(ui.movingComboBox.currentNode(), ui.fixedComboBox.currentNode())
        self._woken.emit()

    def _chooseTarget(self, node: Any = None) -> None:
        self._logic.chooseTarget(node)
        self._woken.emit()

    def _chooseKind(self, _index: int = 0) -> None:
        with showErrors(_("The fit cannot be shown.")):
            self._logic.chooseKind(chosenData(self._ui.kindComboBox))

    def _apply(self, applied: bool) -> None:
        transform = self._logic.transform()
        if transform is not None:
            setApplied(transform, applied)

    def _chooseFiducial(self) -> None:
        """Center the slices on the chosen fiducial."""
        row, shown = self._ui.residualsTable.currentRow(), self._logic.shown
        if shown is not None and 0 <= row < len(shown.labels):
            self._slices.show(shown.fixed_mm[row])
        self._showButtons()

    def _show(self) -> None:
        ui, comparison = self._ui, self._logic.comparison
        setText(ui.registrationText, _summary(comparison) if comparison else self._logic.problem)
        setText(ui.treText, _treText(comparison) if comparison else "", INTERVAL_NOTE)
        fits = [] if comparison is None else _fitRows(comparison)
        fillTable(ui.fitsTable, fits, [INTERVAL_NOTE] * len(fits))
        shown = self._logic.shown
        self._showResiduals(shown)
        self._showRemedies(() if comparison is None else comparison.remedies)
        self._showButtons()
        self._showApplied()

    def _showButtons(self) -> None:
        ui = self._ui
        hasRow = self._logic.shown is not None and ui.residualsTable.currentRow() >= 0
        setEnabled(ui.excludeButton, hasRow, _("Choose a row of the table first."))
        setEnabled(ui.fleButton, hasRow, _("Choose a row of the table first."))
        setEnabled(ui.undoButton, self._logic.canUndo, _("No pair was changed."))

    def _showResiduals(self, shown: Registration | None) -> None:
        """Show the residuals; the chosen fiducial stays chosen, whichever row it is in now."""
        table, row = self._ui.residualsTable, self._ui.residualsTable.currentRow()
        chosen = self._labels[row] if 0 <= row < len(self._labels) else ""
        self._labels = () if shown is None else shown.labels
        wasBlocked = table.blockSignals(True)
        fillTable(table, [] if shown is None else self._residualRows(shown))
        newRow = self._labels.index(chosen) if chosen in self._labels else -1
        if newRow != row:
            table.clearSelection()
            table.setCurrentCell(newRow, 0 if newRow >= 0 else -1)
        table.blockSignals(wasBlocked)

    def _residualRows(self, shown: Registration) -> list[tuple[str, ...]]:
        without: Sequence[float | None] = [None] * len(shown.labels)
        if self._logic.leaveOneOut is not None:
            without = self._logic.leaveOneOut.tolist()
        sizes = dict(self._logic.choices.fle)
        return [
            (label, _number(residual), _number(alone), _number(sizes.get(label)))
            for label, residual, alone in zip(
                shown.labels, shown.residuals_mm, without, strict=True
            )
        ]

    def _showRemedies(self, remedies: tuple[Remedy, ...]) -> None:
        """Show each warning with its button, in place of those before, unless they are the same.

        Otherwise a button could be replaced between press and release, and the press would be lost.
        """
        if remedies == self._remedies:
            return
        self._remedies = remedies
        layout = self._ui.warningsWidget.layout()
        for widget in self._remedyWidgets:
            layout.removeWidget(widget)
            widget.setParent(None)
            widget.deleteLater()
        self._remedyWidgets = []
        for number, remedy in enumerate(remedies):
            text = textLabel("⚠ " + remedy.warning.message)
            text.setObjectName(f"warning{number}Text")
            self._add(layout, text)
            if remedy.title:
                button = qt.QPushButton(buttonTitle(remedy.title))
                button.setObjectName(f"remedy{number}Button")
                button.minimumWidth = 1
                button.toolTip = _("Apply this change and register again. Undo reverts it.")
                button.connect("clicked()", self._applying(remedy))
                self._add(layout, button)

    def _add(self, layout: Any, widget: Any) -> None:
        layout.addWidget(widget)
        self._remedyWidgets.append(widget)

    def _applying(self, remedy: Remedy) -> Callable[[], None]:
        def apply() -> None:
            with showErrors(_("The pairs were not changed.")):
                self._logic.change(remedy.choices)

        return apply


def _summary(comparison: Comparison) -> str:
    pairs = comparison.pairs
    sentence = _("{count} pairs are registered.").format(count=len(pairs.labels))
    if pairs.missing:
        sentence += " " + _("Not touched yet: {labels}.").format(labels=", ".join(pairs.missing))
    if pairs.excluded:
        sentence += " " + _(
            "Left out: {labels}; the score of the trial still uses all pairs."
        ).format(labels=", ".join(pairs.excluded))
    if comparison.fits[RIGID].weights is not None:
        sentence += " " + _(
            "The rigid fit is weighted by the stated FLE; the score of the trial is not."
        )
    return sentence


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
        if fit is None:
            rows.append((title, "–", "–", "–", "–"))
            continue
        interval = "–" if error is None else "{:.2f}–{:.2f}".format(*error.interval_mm)
        expected = "–" if error is None else f"{error.expected_mm:.2f}"
        largest = f"{fit.residuals_mm.max():.2f}"
        rows.append((title, f"{fit.fre_mm:.2f}", largest, expected, interval))
    return rows


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f}"
