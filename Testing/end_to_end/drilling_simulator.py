"""The simulator with a trainee at a drill, who obeys the lines of its standard input.

Each line is one of `DEEDS`; after it, the state of the drill is printed.
"""

from __future__ import annotations

import json
import sys
import threading
from collections import deque
from functools import partial
from unittest import mock

from rastrainer.decision.drill_record import CASES, Decision, Fault
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.decision import forms
from rastrainer_simulator.decision.drill import TIP
from rastrainer_simulator.flow.session.session import TrainingSession

SAYS = "drill: "
DEEDS = {
    "check": lambda drill: drill.check(TIP),
    "read": lambda drill: drill.read_images(),
    "decide": lambda drill: drill.decide(Decision.STOP, 80, Fault.MOVED_HEAD),
    "next": lambda drill: drill.next_case(),
    "see": lambda _drill: None,
}


def seen_of(session):
    drill = session.drill
    return {
        "trialId": drill.trial_id,
        "number": drill.number,
        "timeS": drill.time_s,
        "checks": drill.checks,
        "hasReadImages": drill.has_read_images,
        "isDecided": drill.decided is not None,
        "seed": drill.case.seed,
        "isFinished": drill.is_finished,
    }


def quick_form(maker, random, _seen):
    """Return cases that are quick to draw: other tests cover balanced forms."""
    seeds = map(int, random.integers(2**31, size=CASES))
    return tuple(maker.case(seed, Fault.BAD_FIDUCIAL) for seed in seeds)


def play(asked):
    """Run the simulator, which does the next deed in `asked` whenever a case is ready."""
    advance = TrainingSession.advance

    def advanced(session, dt, state):
        advance(session, dt, state)
        if not asked:
            return
        if session.drill is None:
            session.trainee = asked.popleft()
            session.begin_drill()
        elif session.drill.is_ready:
            DEEDS[asked.popleft()](session.drill)
            while not session.drill.is_recorded:
                session.drill.advance(0.0)
            # The pages show the previous case.
            session.pages.show_start()
            if session.drill.is_ready:
                print(SAYS + json.dumps(seen_of(session)), flush=True)

    patched = mock.patch.multiple
    with patched(TrainingSession, advance=advanced), patched(forms, draw_form=quick_form):
        return main(["simulator", *sys.argv[1:]])


if __name__ == "__main__":
    lines = deque()
    read = partial(lines.extend, map(str.strip, sys.stdin))
    threading.Thread(target=read, daemon=True).start()
    sys.exit(play(lines))
