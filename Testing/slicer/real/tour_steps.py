"""The steps of the tour in their order: one story through every section of the module."""

from __future__ import annotations

from collections.abc import Callable

import tour_afterward
import tour_end
import tour_landmarks
import tour_procedure
import tour_scenarios
import tour_trial
from tour_stage import Tour

STEPS: tuple[tuple[str, Callable[[Tour], str | None]], ...] = (
    ("Open the module", tour_trial.open_module),
    ("Connect to a web page", tour_trial.connect_to_web_page),
    ("Start and connect", tour_trial.start_and_connect),
    ("Create a trainee", tour_trial.create_trainee),
    ("Show scenario and robot", tour_trial.show_scenario),
    ("Abort the trial run", tour_trial.abort_trial_run),
    ("Start task 1", tour_trial.start_task),
    ("Touch points 1 to 7", tour_trial.touch_some),
    ("Pause and resume", tour_trial.pause_and_resume),
    ("Close the scene in mid-trial", tour_trial.close_scene_during_trial),
    ("Touch points 8 to 15", tour_trial.touch_the_others),
    ("Mend the registration", tour_trial.fix_registration),
    ("Register and score", tour_trial.score),
    ("Plan a target", tour_afterward.plan),
    ("Keep a trajectory", tour_afterward.keep_trajectory),
    ("Replay the trial", tour_afterward.replay),
    ("Show tables and plots", tour_afterward.tables_and_plots),
    ("Export", tour_afterward.export),
    ("Write the report", tour_afterward.report),
    ("Plan a procedure", tour_procedure.plan),
    ("Start task 1 with a procedure", tour_procedure.start),
    ("Register again, and verify", tour_procedure.verify),
    ("Align the guide by the robot", tour_procedure.align),
    ("Drill", tour_procedure.drill),
    ("Insert the instrument", tour_procedure.insert),
    ("Save and load the scene", tour_afterward.save_and_load_scene),
    ("Place the landmarks of a head", tour_landmarks.place),
    ("Save a scenario and add it", tour_scenarios.zip_file),
    ("Compare the methods of registration", tour_scenarios.compare_methods),
    ("Preview and check a head", tour_scenarios.preview_and_check),
    ("Make a scenario from a volume", tour_scenarios.scenario_from_volume),
    ("Set a curriculum", tour_end.curriculum),
    ("Lead through a study", tour_end.study),
    ("Delete every node", tour_end.delete_every_node),
    ("Delete the trainee and stop", tour_end.delete_trainee_and_stop),
    ("Start and stop by the section", tour_end.start_and_stop),
)

NEEDED = (tour_trial.open_module, tour_trial.start_and_connect)
"""Without these none of the others makes sense."""
