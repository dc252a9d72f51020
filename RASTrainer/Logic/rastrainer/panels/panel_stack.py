"""The panels of the module, one a workflow step, each from a `.ui` file of its own."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import slicer

from rastrainer.panels.new_scenario_panel import NewScenarioPanel
from rastrainer.panels.plan_panel import PlanPanel
from rastrainer.panels.registration_panel import RegistrationPanel
from rastrainer.panels.scenario_panel import ScenarioPanel
from rastrainer.panels.score_panel import ScorePanel
from rastrainer.panels.simulator_panel import SimulatorPanel
from rastrainer.panels.study_panel import StudyPanel
from rastrainer.panels.trainees_panel import TraineesPanel
from rastrainer.panels.training_panel import TrainingPanel
from rastrainer.slicer.session import Session

PANELS = (
    SimulatorPanel,
    TraineesPanel,
    ScenarioPanel,
    NewScenarioPanel,
    StudyPanel,
    TrainingPanel,
    RegistrationPanel,
    PlanPanel,
    ScorePanel,
)
"""In the order of the work."""


class PanelStack:
    """Loads the panels into a widget, one below the other.

    Attributes:
        ui: all their widgets by name.
    """

    def __init__(
        self, container: Any, resourcePath: Callable[[str], str], session: Session
    ) -> None:
        layout = container.layout()
        widgets = [slicer.util.loadUI(resourcePath(f"UI/{kind.__name__}.ui")) for kind in PANELS]
        for place, widget in enumerate(widgets):
            layout.insertWidget(place, widget)
            # Nodes can be chosen only from a scene.
            widget.setMRMLScene(slicer.mrmlScene)
        self.ui = slicer.util.childWidgetVariables(container)
        self._panels = [kind(self.ui, session) for kind in PANELS]

    def showState(self) -> None:
        """Show what changes without a word: the scene, and time."""
        for panel in self._panels:
            if hasattr(panel, "showState"):
                panel.showState()

    def close(self) -> None:
        """Listen to nothing more."""
        for panel in self._panels:
            panel.close()
