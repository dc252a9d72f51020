"""Classes and members that the measurement of Slicer 5.13 left out, from Qt 5.15's documentation.

Of these, only what the module uses stands here; for each class its base and its members: `.x` is a
property, `x(…)` a signal, any other a method or a constant.
"""

UNMEASURED: dict[str, tuple[str, str]] = {
    "QObject": ("", ".objectName blockSignals children className deleteLater parent property"),
    "QLayout": ("QVBoxLayout", ""),
    "QAbstractButton": ("QPushButton", ""),
    "QAbstractItemView": ("QTableView", ""),
    "QHeaderView": (
        "QFrame",
        ".stretchLastSection .defaultSectionSize ResizeToContents Stretch Interactive Fixed"
        " setSectionResizeMode setStretchLastSection resizeSection sectionSize hideSection"
        " setSectionHidden setSectionsClickable resizeSections count",
    ),
    "QScrollBar": ("QSlider", ""),
    "QByteArray": ("", "data isEmpty size length toBase64"),
    "QFile": ("", "exists open close ReadOnly fileName"),
    "QUiLoader": ("", "load"),
    "QUrl": ("", "fromLocalFile toLocalFile toString isValid"),
    "QFont": ("", "setBold bold setItalic setPointSize pointSize setFamily Monospace setStyleHint"),
    "QBrush": ("", "color setColor style"),
    "QCursor": ("", "shape pos"),
    "qSlicerMainWindow": ("QWidget", "statusBar moduleSelector"),
    "QPoint": ("", "x y"),
    "QRect": ("", "x y width height"),
    "QSizePolicy": ("", "Expanding Preferred Fixed Minimum MinimumExpanding Ignored Maximum"),
    "QKeySequence": ("", "toString"),
    "QDesktopServices": ("", "openUrl"),
    "QEvent": ("", "type Resize Show Hide KeyPress"),
    "QPalette": ("", "color setColor Window WindowText Base Text Highlight"),
    "QSpacerItem": ("", ""),
    "QWidgetItem": ("", "widget layout spacerItem"),
    "QDate": ("", "toString"),
    "QTime": ("", "toString"),
    "QTextDocument": ("QObject", "toPlainText clear"),
    "QTextCursor": ("", "End movePosition"),
    "QModelIndex": ("", "row column isValid"),
    "QClipboard": ("QObject", "setText text"),
    "QFontMetrics": ("", "height horizontalAdvance"),
    "QStyle": ("QObject", "standardIcon"),
    "qSlicerScriptedLoadableModuleWidget": ("QWidget", ".isEntered .moduleName setMRMLScene"),
}

# Static functions that stood behind a property of the same name when the classes were measured.
EXTRA_MEMBERS: dict[str, str] = {}
