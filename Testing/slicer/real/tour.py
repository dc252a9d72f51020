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
from pathlib import Path

import slicer


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

    from tour_record import Record
    from tour_stage import Tour
    from tour_steps import NEEDED, STEPS

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
    return 0 if record.write(tour.hands.unused_buttons()) else 1


if __name__ == "__main__":
    slicer.util.exit(main(sys.argv[1:]))
