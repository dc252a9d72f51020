"""The classes of Slicer that the host offers."""

_NAMES = {
    "qt": """
        QAction QApplication QButtonGroup QCheckBox QColor QComboBox QDateTime QDialog
        QDoubleSpinBox QFileDialog QFormLayout QFrame QGridLayout QGroupBox QHBoxLayout QIcon
        QInputDialog QLabel QLineEdit QListWidget QMenu QMessageBox QPixmap QPlainTextEdit
        QProcess QProcessEnvironment QProgressBar QProgressDialog QPushButton QRadioButton
        QScrollArea QSettings QSize QSlider QSpinBox QSplitter QStackedWidget QStandardPaths
        QTabWidget QTableView QTableWidget QTableWidgetItem QTextBrowser QTextEdit QTimer
        QToolButton QTreeWidget QVBoxLayout QWidget
    """,
    "ctk": """
        ctkCollapsibleButton ctkCollapsibleGroupBox ctkComboBox ctkDirectoryButton
        ctkMessageBox ctkPathLineEdit ctkPushButton ctkSliderWidget
    """,
    "qMRML": """
        qMRMLNodeComboBox qMRMLPlotView qMRMLPlotWidget qMRMLTableView qMRMLWidget
        qMRMLSliceWidget qMRMLSliceView qMRMLThreeDWidget qMRMLThreeDView
    """,
}
OFFERED = {module: tuple(names.split()) for module, names in _NAMES.items()}
