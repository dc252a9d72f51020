"""The panels of the module, one a workflow step, each from a `.ui` file of its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import slicer

from rastrainer.panels.new_scenario_panel import NewScenarioPanel
from rastrainer.panels.next_step_panel import NextStepPanel
from rastrainer.panels.plan_panel import PlanPanel
from rastrainer.panels.registration_panel import RegistrationPanel
from rastrainer.panels.running_simulator_panel import RunningSimulatorPanel
from rastrainer.panels.scenario_panel import ScenarioPanel
from rastrainer.panels.score_panel import ScorePanel
from rastrainer.panels.setup_panel import SetupPanel
from rastrainer.panels.simulator_panel import SimulatorPanel
from rastrainer.panels.study_panel import StudyPanel
from rastrainer.panels.trainees_panel import TraineesPanel
from rastrainer.panels.training_panel import TrainingPanel
from rastrainer.slicer.next_step import Action
from rastrainer.slicer.session import Session

SECTIONS = (
    SetupPanel,
    RunningSimulatorPanel,
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
PANELS = (
    NextStepPanel,
    *SECTIONS,
)
"""From above to below."""


class PanelStack:
    """Loads the panels into a widget, one below the other.

    Attributes:
        ui: all their widgets by name.
    """

    def __init__(
        self, container: Any, resourcePath: Callable[[str], str], session: Session
    ) -> None:
        layout = container.layout()
        names = [kind.__name__ for kind in PANELS]
        widgets = [slicer.util.loadUI(resourcePath(f"UI/{name}.ui")) for name in names]
        for place, widget in enumerate(widgets):
            layout.insertWidget(place, widget)
            # Nodes can be chosen only from a scene.
            widget.setMRMLScene(slicer.mrmlScene)
        self.ui = slicer.util.childWidgetVariables(container)
        sections = {kind: kind(self.ui, session) for kind in SECTIONS}
        line = NextStepPanel(self.ui, session, _actions(sections))
        self._panels = [*sections.values(), line]

    def showState(self) -> None:
        """Show what changes without a word: the scene, and time."""
        for panel in self._panels:
            if hasattr(panel, "showState"):
                panel.showState()

    def close(self) -> None:
        """Listen to nothing more."""
        for panel in self._panels:
            panel.close()


def _actions(sections: Mapping[type, Any]) -> dict[Action, Callable[[], None]]:
    """Return what the line at the top lets the sections do."""
    return {
        Action.START_SIMULATOR: sections[SimulatorPanel].startAndConnect,
        Action.CONNECT: sections[SimulatorPanel].toggleConnection,
        Action.CONNECT_TO_RUNNING: sections[RunningSimulatorPanel].connectToIt,
        Action.CREATE_TRAINEE: sections[TraineesPanel].createTrainee,
        Action.START_STUDY_STEP: sections[StudyPanel].startStep,
        Action.EXPLAIN_REPEAT: sections[StudyPanel].explainRepeat,
        Action.START_TRIAL_RUN: sections[TrainingPanel].startTrialRun,
        Action.START_TASK: sections[TrainingPanel].startTask,
        Action.PAUSE: sections[TrainingPanel].pauseOrResume,
        Action.RESUME: sections[TrainingPanel].pauseOrResume,
    }
