"""The panels of the module, one a workflow step, each from a separate `.ui` file."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import slicer

from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.new_scenario_panel import LandmarksPanel, NewScenarioPanel
from rastrainer.sections.next_step_logic import NextAction
from rastrainer.sections.next_step_panel import NextStepPanel
from rastrainer.sections.procedure_panel import ProcedurePanel
from rastrainer.sections.procedure_plan_panel import ProcedurePlanPanel
from rastrainer.sections.registration_panel import RegistrationPanel
from rastrainer.sections.scenario_panel import MethodsPanel, ScenarioPanel
from rastrainer.sections.score_panel import ScorePanel
from rastrainer.sections.simulator_panel import RunningSimulatorPanel, SetupPanel, SimulatorPanel
from rastrainer.sections.study_panel import CurriculumPanel, StudyPanel
from rastrainer.sections.target_plan_panel import PlanPanel
from rastrainer.sections.trainees_panel import TraineesPanel
from rastrainer.sections.training_panel import TrainingPanel
from rastrainer.widgets.section_layout import configureWidgets

SECTIONS = (
    SetupPanel,
    RunningSimulatorPanel,
    SimulatorPanel,
    TraineesPanel,
    ScenarioPanel,
    NewScenarioPanel,
    ProcedurePlanPanel,
    StudyPanel,
    TrainingPanel,
    RegistrationPanel,
    PlanPanel,
    ProcedurePanel,
    ScorePanel,
)
"""In the order of the work."""
NESTED = (CurriculumPanel, LandmarksPanel, MethodsPanel)
"""Panels whose widgets are in the files of other sections."""


class PanelStack:
    """Loads the panels into a widget, one below the other.

    Attributes:
        ui: all their widgets by name, once they are loaded.
    """

    def __init__(self) -> None:
        self.ui: Any = SimpleNamespace()
        self._panels: list[Any] = []

    def build(
        self, container: Any, resourcePath: Callable[[str], str], session: ModuleSession
    ) -> Iterator[None]:
        """Build all in small steps, each for a turn of the event loop."""
        layout = container.layout()
        for place, kind in enumerate((NextStepPanel, *SECTIONS)):
            widget = slicer.util.loadUI(resourcePath(f"UI/RASTrainer{kind.__name__}.ui"))
            layout.insertWidget(place, widget)
            # Only the next step stands apart.
            widget.layout().setContentsMargins(0, 0, 0, 0 if place else 4)
            named = vars(slicer.util.childWidgetVariables(widget))
            configureWidgets(named.values())
            # Nodes can be chosen only from a scene; a box must know before that it may be empty.
            widget.setMRMLScene(slicer.mrmlScene)
            vars(self.ui).update(named)
            yield
        panels: dict[type, Any] = {}
        for kind in (*SECTIONS, *NESTED):
            yield
            panels[kind] = kind(self.ui, session)
            self._panels.append(panels[kind])
        self._panels.append(
            NextStepPanel(
                self.ui,
                session,
                {
                    NextAction.START_SIMULATOR: panels[SimulatorPanel].startAndConnect,
                    NextAction.CONNECT: panels[SimulatorPanel].connect,
                    NextAction.CONNECT_TO_RUNNING: panels[RunningSimulatorPanel].connectToIt,
                    NextAction.CREATE_TRAINEE: panels[TraineesPanel].createTrainee,
                    NextAction.START_STUDY_STEP: panels[StudyPanel].startStep,
                    NextAction.EXPLAIN_REPEAT: panels[StudyPanel].explainRepeat,
                    NextAction.START_TRIAL_RUN: panels[TrainingPanel].startTrialRun,
                    NextAction.START_TASK: panels[TrainingPanel].startTask,
                    NextAction.PAUSE: panels[TrainingPanel].pause,
                    NextAction.RESUME: panels[TrainingPanel].resume,
                },
            )
        )

    def close(self) -> None:
        for panel in self._panels:
            panel.close()
