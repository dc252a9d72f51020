"""CTK's buttons, what can be collapsed, and the input of a path."""

from __future__ import annotations

from PySide6 import QtCore, QtGui, QtWidgets

Style = QtWidgets.QStyle
MARGIN = 4
WITHOUT_LIMIT = 16777215
COLLAPSED_HEIGHT = 10
"""Pixels below the header of a closed section, unless it has another height."""


class Folding(QtCore.QObject):
    """Hides the children of a widget, also those added while it is collapsed.

    As in CTK, a child that is hidden or shown meanwhile is so when the widget is opened.
    """

    def __init__(self, widget: QtWidgets.QWidget) -> None:
        super().__init__()
        self._widget = widget
        self._hidden: list[QtWidgets.QWidget] = []
        self._isAtWork = False
        self.is_collapsed = False

    def fold(self, is_collapsed: bool) -> None:
        """Hide the children, or show again those that were shown before."""
        self.is_collapsed = is_collapsed
        if is_collapsed:
            self.hide_children()
            return
        self._isAtWork = True
        for child in self._hidden:
            child.show()
        self._isAtWork = False
        self._hidden = []

    def hide_children(self) -> None:
        """Hide those children that are not hidden yet."""
        direct = QtCore.Qt.FindChildOption.FindDirectChildrenOnly
        for child in self._widget.findChildren(QtWidgets.QWidget, options=direct):
            child.installEventFilter(self)
            if not child.isHidden():
                self._hide(child)

    def heed(self, event: QtCore.QEvent) -> None:
        """Hide a child that was just added."""
        kinds = (QtCore.QEvent.Type.ChildPolished, QtCore.QEvent.Type.LayoutRequest)
        if self.is_collapsed and event.type() in kinds:
            self.hide_children()

    def eventFilter(self, child: QtCore.QObject, event: QtCore.QEvent) -> bool:
        """Remember what a child is to be when the collapsed widget is opened."""
        if self.is_collapsed and not self._isAtWork:
            if event.type() == QtCore.QEvent.Type.HideToParent and child in self._hidden:
                self._hidden.remove(child)
            elif event.type() == QtCore.QEvent.Type.ShowToParent:
                self._hide(child)
        return False

    def _hide(self, child: QtWidgets.QWidget) -> None:
        self._isAtWork = True
        if child not in self._hidden:
            self._hidden.append(child)
        child.hide()
        # Otherwise Qt would send no event when it is hidden once more.
        child.setAttribute(QtCore.Qt.WidgetAttribute.WA_WState_ExplicitShowHide, False)
        self._isAtWork = False


class Collapsible:
    """What both widgets have in common: they are checked while they are open."""

    def prepare(self) -> None:
        self._folding = Folding(self)
        self.setCheckable(True)
        self.setChecked(True)
        self.toggled.connect(lambda isOpen: self.setCollapsed(not isOpen))

    def isCollapsed(self) -> bool:
        return self._folding.is_collapsed

    def setCollapsed(self, collapsed: bool) -> None:
        if collapsed == self.isCollapsed():
            return
        self._folding.fold(collapsed)
        self.setChecked(not collapsed)
        self.setMaximumHeight(self.folded_height() if collapsed else WITHOUT_LIMIT)
        self.updateGeometry()
        self.contentsCollapsed.emit(collapsed)

    def event(self, event: QtCore.QEvent) -> bool:
        self._folding.heed(event)
        return super().event(event)


class ctkCollapsibleButton(Collapsible, QtWidgets.QAbstractButton):
    """A header that hides the content below it."""

    contentsCollapsed = QtCore.Signal(bool)

    def __init__(self, *arguments: object) -> None:
        super().__init__(*(item for item in arguments if isinstance(item, QtWidgets.QWidget)))
        for text in arguments:
            if isinstance(text, str):
                self.setText(text)
        self.prepare()
        # As in CTK: all that is in it has, as its least width, that which it would like to have.
        policy = QtWidgets.QSizePolicy.Policy
        self.setSizePolicy(policy.Minimum, policy.Preferred)
        self._collapsed_height = COLLAPSED_HEIGHT
        self.setContentsMargins(0, self._header_height(), 0, 0)

    def setCollapsedHeight(self, height: int) -> None:
        self._collapsed_height = height
        self.updateGeometry()

    collapsedHeight = QtCore.Property(int, lambda self: self._collapsed_height, setCollapsedHeight)

    collapsed = QtCore.Property(bool, Collapsible.isCollapsed, Collapsible.setCollapsed)

    def folded_height(self) -> int:
        return self.sizeHint().height()

    def sizeHint(self) -> QtCore.QSize:
        header = QtCore.QSize(
            self.fontMetrics().horizontalAdvance(self.text()) + 40, self._header_height()
        )
        below = QtCore.QSize(0, self._collapsed_height)
        if self.layout() is None or self.isCollapsed():
            return header + below
        return self.layout().totalSizeHint().expandedTo(header + below)

    def minimumSizeHint(self) -> QtCore.QSize:
        if self.layout() is None or self.isCollapsed():
            return self.sizeHint()
        return self.layout().totalMinimumSize()

    def hitButton(self, position: QtCore.QPoint) -> bool:
        return position.y() < self._header_height()

    def paintEvent(self, _event: QtGui.QPaintEvent) -> None:
        painter = QtWidgets.QStylePainter(self)
        header = QtCore.QRect(0, 0, self.width(), self._header_height())
        option = QtWidgets.QStyleOptionButton()
        option.initFrom(self)
        option.rect = header
        painter.drawControl(Style.ControlElement.CE_PushButtonBevel, option)
        _draw_arrow(self, painter, QtCore.QRect(6, 0, 12, header.height()), self.isCollapsed())
        place = header.adjusted(24, 0, -MARGIN, 0)
        painter.drawText(place, QtCore.Qt.AlignmentFlag.AlignVCenter, self.text())

    def _header_height(self) -> int:
        return self.fontMetrics().height() + 2 * MARGIN


class ctkCollapsibleGroupBox(Collapsible, QtWidgets.QGroupBox):
    """A group box whose title hides its contents."""

    contentsCollapsed = QtCore.Signal(bool)

    def __init__(self, *arguments: object) -> None:
        super().__init__(*arguments)
        self.prepare()

    collapsed = QtCore.Property(bool, Collapsible.isCollapsed, Collapsible.setCollapsed)

    def minimumSizeHint(self) -> QtCore.QSize:
        hint = super().minimumSizeHint()
        return QtCore.QSize(hint.width(), self.folded_height()) if self.isCollapsed() else hint

    def paintEvent(self, _event: QtGui.QPaintEvent) -> None:
        painter = QtWidgets.QStylePainter(self)
        option = QtWidgets.QStyleOptionGroupBox()
        self.initStyleOption(option)
        kind, parts = Style.ComplexControl.CC_GroupBox, Style.SubControl
        arrow, label = (
            self.style().subControlRect(kind, option, part, self)
            for part in (parts.SC_GroupBoxCheckBox, parts.SC_GroupBoxLabel)
        )
        if not self.isCollapsed():
            option.subControls = parts.SC_GroupBoxFrame
            painter.drawComplexControl(kind, option)
        _draw_arrow(self, painter, arrow, self.isCollapsed())
        painter.drawText(label, QtCore.Qt.AlignmentFlag.AlignVCenter, self.title())

    def folded_height(self) -> int:
        return self.fontMetrics().height() + MARGIN


def _draw_arrow(
    widget: QtWidgets.QWidget,
    painter: QtWidgets.QStylePainter,
    place: QtCore.QRect,
    is_collapsed: bool,
) -> None:
    option = QtWidgets.QStyleOption()
    option.initFrom(widget)
    option.rect = place
    kinds = Style.PrimitiveElement
    kind = kinds.PE_IndicatorArrowRight if is_collapsed else kinds.PE_IndicatorArrowDown
    painter.drawPrimitive(kind, option)


PATH_FRAME = 60
"""Pixels around the path: its combo box's frame and arrow, and the button to browse."""


class ctkPathLineEdit(QtWidgets.QWidget):
    """A line for a path, and a button to browse for one.

    It is as wide as its path unless it is configured, like CTK's: a long path widens the dock.
    """

    Dirs, Files, Drives, NoSymLinks, Readable, Writable, Executable = (1 << n for n in range(7))

    currentPathChanged = QtCore.Signal(str)
    validInputChanged = QtCore.Signal(bool)

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(parent)
        self._edit = QtWidgets.QLineEdit()
        self._filters = self.Dirs | self.Files | self.Drives
        self._nameFilters: list[str] = []
        button = QtWidgets.QToolButton()
        button.setText("…")
        row = QtWidgets.QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self._edit)
        row.addWidget(button)
        self._edit.textChanged.connect(self.currentPathChanged)

    def minimumSizeHint(self) -> QtCore.QSize:
        hint = super().minimumSizeHint()
        text = self._edit.text()
        width = self._edit.fontMetrics().horizontalAdvance(text or 7 * "x")
        return hint.expandedTo(QtCore.QSize(width + PATH_FRAME, 0))

    def setCurrentPath(self, path: str) -> None:
        self._edit.setText(path)

    currentPath = QtCore.Property(str, lambda self: self._edit.text(), setCurrentPath)

    def _set_filters(self, filters: int) -> None:
        self._filters = filters

    filters = QtCore.Property(int, lambda self: self._filters, _set_filters)

    def _set_name_filters(self, filters: list[str]) -> None:
        self._nameFilters = filters

    nameFilters = QtCore.Property("QStringList", lambda self: self._nameFilters, _set_name_filters)
