"""CTK's buttons."""

from __future__ import annotations

from PySide6 import QtCore, QtGui, QtWidgets


class ctkCollapsibleButton(QtWidgets.QAbstractButton):
    """A header that hides what is laid out below it."""

    contentsCollapsed = QtCore.Signal(bool)

    def __init__(self, *arguments: object) -> None:
        super().__init__(*(item for item in arguments if isinstance(item, QtWidgets.QWidget)))
        self._isCollapsed = False
        self._hidden: list[QtWidgets.QWidget] = []
        for text in arguments:
            if isinstance(text, str):
                self.setText(text)
        self.setCheckable(True)
        self.setChecked(True)
        self.toggled.connect(lambda isOpen: self.setCollapsed(not isOpen))
        self.setSizePolicy(
            QtWidgets.QSizePolicy.Policy.Preferred, QtWidgets.QSizePolicy.Policy.Preferred
        )
        self.setContentsMargins(0, self._header_height(), 0, 0)

    def isCollapsed(self) -> bool:
        return self._isCollapsed

    def setCollapsed(self, collapsed: bool) -> None:
        if collapsed == self._isCollapsed:
            return
        self._isCollapsed = collapsed
        self.setChecked(not collapsed)
        children = self.findChildren(
            QtWidgets.QWidget, options=QtCore.Qt.FindChildOption.FindDirectChildrenOnly
        )
        if collapsed:
            self._hidden = [child for child in children if not child.isHidden()]
        for child in self._hidden:
            child.setVisible(not collapsed)
        self.setMaximumHeight(self._header_height() + 4 if collapsed else 16777215)
        self.updateGeometry()
        self.contentsCollapsed.emit(collapsed)

    collapsed = QtCore.Property(bool, isCollapsed, setCollapsed)

    def sizeHint(self) -> QtCore.QSize:
        inner = self.layout().sizeHint() if self.layout() and not self._isCollapsed else None
        width = self.fontMetrics().horizontalAdvance(self.text()) + 40
        if inner is None:
            return QtCore.QSize(width, self._header_height() + 4)
        return QtCore.QSize(max(width, inner.width()), inner.height())

    def minimumSizeHint(self) -> QtCore.QSize:
        if self.layout() is None or self._isCollapsed:
            return self.sizeHint()
        return self.layout().minimumSize()

    def hitButton(self, position: QtCore.QPoint) -> bool:
        return position.y() < self._header_height()

    def paintEvent(self, _event: QtGui.QPaintEvent) -> None:
        painter = QtWidgets.QStylePainter(self)
        header = QtCore.QRect(0, 0, self.width(), self._header_height())
        option = QtWidgets.QStyleOptionButton()
        option.initFrom(self)
        option.rect = header
        painter.drawControl(QtWidgets.QStyle.ControlElement.CE_PushButtonBevel, option)
        arrow = QtWidgets.QStyleOption()
        arrow.initFrom(self)
        arrow.rect = QtCore.QRect(6, 0, 12, header.height())
        painter.drawPrimitive(
            QtWidgets.QStyle.PrimitiveElement.PE_IndicatorArrowRight
            if self._isCollapsed
            else QtWidgets.QStyle.PrimitiveElement.PE_IndicatorArrowDown,
            arrow,
        )
        painter.drawText(
            header.adjusted(24, 0, -4, 0), QtCore.Qt.AlignmentFlag.AlignVCenter, self.text()
        )

    def _header_height(self) -> int:
        return self.fontMetrics().height() + 8


class ctkCollapsibleGroupBox(QtWidgets.QGroupBox):
    """A group box whose title hides its contents."""

    def __init__(self, *arguments: object) -> None:
        super().__init__(*arguments)
        self._isCollapsed = False
        self._hidden: list[QtWidgets.QWidget] = []

    def isCollapsed(self) -> bool:
        return self._isCollapsed

    def setCollapsed(self, collapsed: bool) -> None:
        if collapsed == self._isCollapsed:
            return
        self._isCollapsed = collapsed
        children = self.findChildren(
            QtWidgets.QWidget, options=QtCore.Qt.FindChildOption.FindDirectChildrenOnly
        )
        if collapsed:
            self._hidden = [child for child in children if not child.isHidden()]
        for child in self._hidden:
            child.setVisible(not collapsed)
        self.updateGeometry()

    collapsed = QtCore.Property(bool, isCollapsed, setCollapsed)


class ctkPushButton(QtWidgets.QPushButton):
    """A push button."""
