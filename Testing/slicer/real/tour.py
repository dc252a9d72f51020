"""Takes a real Slicer through the whole module, and reports what does not work; for releases.

    Slicer --python-script Testing/slicer/real/tour.py -- --output DIR

Every section is worked by its real widgets: simulator, trainee, a trial that a scripted trainee
plays, registration, plan, score, replay, report, a procedure and its plan, scenes, a scenario from
a volume, a study. DIR gets a picture of each step, and a table of them as `tour.json` and
`tour.md`, with the buttons that no step has clicked, and what Slicer has logged as an error
meanwhile. The exit status is 0 if all is well. It takes some minutes.

The module must be installed with SlicerOpenIGTLink. The simulator is set up first where it is not
yet. Without a main window (`--no-main-window`) the pictures show the panel alone; with `--testing`
Slicer answers all questions with no, so that the tour refuses to begin.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

import slicer
import tour_afterward
import tour_end
import tour_procedure
import tour_scenarios
import tour_trial
from tour_record import Record
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
    ("Place the landmarks of a head", tour_scenarios.landmarks),
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


def main(words: list[str]) -> int:
    """Take the tour; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, required=True, help="folder of the pictures")
    parser.add_argument("--program", default="", help="a rastrainer that is installed elsewhere")
    parser.add_argument("--only", nargs="+", default=(), help="names of steps; all if left out")
    parser.add_argument("--patience", type=float, default=120.0, help="seconds for each wait")
    parser.add_argument("--window", action="store_true", help="open the trainee's window, too")
    # Slicer passes on the dashes between its arguments and the script's.
    arguments = parser.parse_args([word for word in words if word != "--"])
    if slicer.app.testingEnabled():
        print("Start Slicer without --testing: with it, all questions are answered with no.")
        return 2

    tour = Tour(arguments.output, arguments.program, arguments.window, arguments.patience)
    record = Record(arguments.output, tour.panel)
    try:
        for name, step in STEPS:
            if arguments.only and name not in arguments.only:
                continue
            if not record.do(name, lambda step=step: step(tour)) and step in NEEDED:
                break
    finally:
        tour.close()
    return 0 if record.write(tour.unused_buttons()) else 1


if __name__ == "__main__":
    slicer.util.exit(main(sys.argv[1:]))
