"""A trainee in a separate process, over OpenIGTLink: touches, and feeds drill and instrument.

Run by Slicer's own Python, which the tour does. The journal of the trial says where the head
stands, which a person sees on the screen. Depths are measured along the plan.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

ABOVE_MM, SINK_MM, SLIP_MM = 40.0, 1.0, 6.0
"""Distances of the tip: above the skin in travel, below it in a touch, to the side at a slip."""
NEAR_ENOUGH_MM = 1.5
TRAVEL_MM_S, TOUCH_MM_S = 400, 100
LOOK_EVERY_S = 0.2
STAND_OFF_MM = 30.0
"""Where the robot stops before the planned entry, by default."""
PAST_INNER_MM = 1.0
"""The drill goes so far past the planned inner table: the bone is not where it is shown."""
FEED_MM_S, LONGEST_FEED_S, FED_MM = 5.0, 2.0, 0.1


def main() -> int:
    """Do what the arguments say; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--logic", type=Path, required=True, help="folder of rastrainer")
    parser.add_argument("--scenario", type=Path, required=True, help="folder of the scenario")
    parser.add_argument("--records", type=Path, required=True, help="folder of the journals")
    parser.add_argument("--port", type=int, required=True, help="of the simulator")
    parser.add_argument("--patience", type=float, default=120.0, help="seconds for each wait")
    parser.add_argument("--await", dest="awaited", metavar="NAME", help="wait for this scenario")
    parser.add_argument("--points", type=int, nargs=2, metavar=("FIRST", "LAST"))
    parser.add_argument("--slip-at", type=int, default=0, help="a point that is not quite touched")
    parser.add_argument("--register", action="store_true", help="register the points afterward")
    parser.add_argument("--checkpoint", type=int, metavar="NUMBER", help="touch one, from 1")
    parser.add_argument("--drill", action="store_true", help="drill through the skull")
    parser.add_argument("--insert", action="store_true", help="bring the instrument to its target")
    arguments = parser.parse_args()
    sys.path.insert(0, str(arguments.logic))

    from rastrainer.igtl.client import Client
    from rastrainer.protocol import PROTOCOL_VERSION

    with Client(port=arguments.port) as link:
        client = TourTrainee(link, arguments.patience)
        # Steady: the pose is waited for after the arm has come to rest, too.
        client.do("Hello", protocolVersion=PROTOCOL_VERSION, client="tour", steady=True)
        if arguments.awaited is not None:
            client.await_scenario(arguments.awaited)
        if arguments.points is not None:
            places = _places(*_trial(arguments))
            first, last = arguments.points
            for number in range(first, last + 1):
                client.touch(*places[number - 1], slips=number == arguments.slip_at)
        if arguments.register:
            client.do("Register")
        if arguments.checkpoint is not None:
            client.touch(*_checkpoint(*_trial(arguments), arguments.checkpoint), slips=False)
        if arguments.drill or arguments.insert:
            client.feed_to(_depth(*_trial(arguments), is_drill=arguments.drill))
    return 0


def _trial(arguments: argparse.Namespace) -> tuple[Any, dict[str, Any]]:
    """Return the scenario, and the beginning of the journal of the running trial."""
    from rastrainer.journal.journal_file import read_journal
    from rastrainer.scenario.scenario import load_scenario

    journals = arguments.records.glob("*.journal")
    journal = max(journals, key=lambda path: path.stat().st_mtime)
    return load_scenario(arguments.scenario), read_journal(journal).header


def _places(scenario: Any, header: dict[str, Any]) -> list[tuple[Any, Any]]:
    """Return each fiducial with the outward direction there: (3,) float, World, mm."""
    from rastrainer import transforms
    from rastrainer.trial.score_reference import fiducial_normals

    head_to_world = scenario.perturbed_head_to_world(header.seed)
    fiducials = transforms.apply(head_to_world, scenario.task(header.task).fiducials)
    normals = fiducial_normals(scenario, header.task) @ head_to_world[:3, :3].T
    return list(zip(fiducials, normals, strict=True))


def _checkpoint(scenario: Any, header: dict[str, Any], number: int) -> tuple[Any, Any]:
    """Return a checkpoint with the outward direction there: (3,) float, World, mm."""
    import numpy as np

    from rastrainer import transforms

    head_to_world = scenario.perturbed_head_to_world(header.seed)
    position = scenario.procedure(header.procedure.name).checkpoints[number - 1].position_ras
    outward = np.asarray(position) - scenario.target.position_ras
    outward /= np.linalg.norm(outward)
    return transforms.apply(head_to_world, position), head_to_world[:3, :3] @ outward


def _depth(scenario: Any, header: dict[str, Any], is_drill: bool) -> float:
    """Return how far drill or instrument must be beyond the guide's tip on the first line, mm."""
    from rastrainer.procedure.checks import planned_bone
    from rastrainer.procedure.plan import read_procedure_meshes

    procedure = scenario.procedure(header.procedure.name)
    line = procedure.trajectories[0]
    if not is_drill:
        return STAND_OFF_MM + line.length_mm
    bone = planned_bone(line, read_procedure_meshes(procedure, scenario.skull.file).skull)
    return STAND_OFF_MM + bone.inner_mm + PAST_INNER_MM


class TourTrainee:
    """Actions of a trainee, by commands; each waits for its end.

    `patience_s` is how long one wait may take.
    """

    def __init__(self, link: Any, patience_s: float) -> None:
        self._link = link
        self._patience_s = patience_s

    def await_scenario(self, name: str) -> None:
        """Wait until the simulator uses a scenario."""
        end = time.monotonic() + self._patience_s
        while self.do("ListTasks")["scenario"] != name:
            if time.monotonic() > end:
                raise SystemExit(f"The simulator does not use {name}.")
            time.sleep(LOOK_EVERY_S)

    def touch(self, place: Any, outward: Any, slips: bool) -> None:
        """Touch the skin at a position; (3,) float, World, mm, with the outward direction there."""
        import numpy as np

        above = place + ABOVE_MM * outward
        self._move(above, TRAVEL_MM_S)
        self._wait_for("ToolTipToWorld", lambda tip: _is_near(tip, above))
        aim = place - SINK_MM * outward
        if slips:
            sideways = np.cross(outward, [0.0, 0.0, 1.0])
            aim = aim + SLIP_MM * sideways / np.linalg.norm(sideways)
        self._move(aim, TOUCH_MM_S)
        self._wait_for("SimState", lambda state: _state(state)["proximity"] == "contact")
        self.do("Capture")
        self._move(above, TRAVEL_MM_S)

    def feed_to(self, depth_mm: float) -> None:
        """Feed drill or instrument until it is so far beyond the guide's tip."""
        fed = self._fed(-1.0)
        while depth_mm - fed > FED_MM:
            seconds = min((depth_mm - fed) / FEED_MM_S, LONGEST_FEED_S)
            self.do("Feed", velocityMmS=FEED_MM_S, durationS=seconds)
            fed = self._fed(fed + FEED_MM_S * seconds - FED_MM)

    def do(self, name: str, /, **arguments: Any) -> Any:
        """Send a command and return its answer."""
        reply = self._link.send_command(name, arguments, self._patience_s)
        if not reply.ok:
            raise SystemExit(f"{name} was refused: {reply.error}")
        return reply.data

    def _fed(self, beyond_mm: float) -> float:
        """Return how far drill or instrument is beyond the guide's tip, once it is far enough."""

        def is_enough(message: Any) -> bool:
            return _state(message)["procedure"]["feedMm"] > beyond_mm

        return _state(self._wait_for("SimState", is_enough))["procedure"]["feedMm"]

    def _move(self, place: Any, speed_mm_s: float) -> None:
        self.do("MoveTipTo", positionMm=place.tolist(), speedMmS=speed_mm_s)

    def _wait_for(self, name: str, is_wanted: Callable[[Any], bool]) -> Any:
        return self._link.wait_for(name, is_wanted, self._patience_s)


def _state(message: Any) -> Any:
    return json.loads(message.content.text)


def _is_near(tip: Any, place: Any) -> bool:
    import numpy as np

    return np.linalg.norm(np.array(tip.content.matrix)[:3, 3] - place) < NEAR_ENOUGH_MM


if __name__ == "__main__":
    sys.exit(main())
