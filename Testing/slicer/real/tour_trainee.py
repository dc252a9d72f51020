"""A trainee in a separate process: touches fiducials of the running trial over OpenIGTLink.

Run by Slicer's own Python, which the tour does. The journal of the trial tells where the head
stands, which a person sees on the screen.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

ABOVE_MM, SINK_MM, SLIP_MM = 40.0, 1.0, 6.0
"""How far above the skin the tip travels, below it is sent, and beside it is at a slip."""
NEAR_ENOUGH_MM = 1.5
TRAVEL_MM_S, TOUCH_MM_S = 400, 100
TIMEOUT_S = 60.0


def main() -> int:
    """Do what the arguments say; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--logic", type=Path, required=True, help="folder of rastrainer")
    parser.add_argument("--scenario", type=Path, required=True, help="folder of the scenario")
    parser.add_argument("--records", type=Path, required=True, help="folder of the journals")
    parser.add_argument("--port", type=int, required=True, help="of the simulator")
    parser.add_argument("--points", type=int, nargs=2, metavar=("FIRST", "LAST"))
    parser.add_argument("--slip-at", type=int, default=0, help="a point that is not quite touched")
    parser.add_argument("--register", action="store_true", help="register the points afterward")
    arguments = parser.parse_args()
    sys.path.insert(0, str(arguments.logic))

    from rastrainer.igtl.client import Client
    from rastrainer.protocol import PROTOCOL_VERSION

    with Client(port=arguments.port) as client:
        # Steady: the pose is waited for after the arm has come to rest, too.
        _do(client, "Hello", protocolVersion=PROTOCOL_VERSION, client="tour", steady=True)
        if arguments.points is not None:
            places = _places(arguments.scenario, arguments.records)
            first, last = arguments.points
            for number in range(first, last + 1):
                _touch(client, *places[number - 1], slips=number == arguments.slip_at)
        if arguments.register:
            _do(client, "Register")
    return 0


def _places(folder: Path, records: Path) -> list[tuple[Any, Any]]:
    """Return each fiducial with the outward direction there: (3,) float, World, mm."""
    from rastrainer import transforms
    from rastrainer.scenario.scenario import load_scenario
    from rastrainer.trial.score_reference import fiducial_normals

    journal = max(records.glob("*.journal"), key=lambda path: path.stat().st_mtime)
    with journal.open(encoding="utf-8") as lines:
        header = json.loads(lines.readline())
    scenario = load_scenario(folder)
    head_to_world = scenario.perturbed_head_to_world(header["seed"])
    fiducials = transforms.apply(head_to_world, scenario.task(header["task"]).fiducials)
    normals = fiducial_normals(scenario, header["task"]) @ head_to_world[:3, :3].T
    return list(zip(fiducials, normals, strict=True))


def _touch(client: Any, fiducial: Any, outward: Any, slips: bool) -> None:
    import numpy as np

    above = fiducial + ABOVE_MM * outward
    _move(client, above, TRAVEL_MM_S)
    client.wait_for("ToolTipToWorld", lambda tip: _is_near(tip, above), TIMEOUT_S)
    aim = fiducial - SINK_MM * outward
    if slips:
        sideways = np.cross(outward, [0.0, 0.0, 1.0])
        aim = aim + SLIP_MM * sideways / np.linalg.norm(sideways)
    _move(client, aim, TOUCH_MM_S)
    client.wait_for("SimState", _is_in_contact, TIMEOUT_S)
    _do(client, "Capture")
    _move(client, above, TRAVEL_MM_S)


def _is_in_contact(state: Any) -> bool:
    return json.loads(state.content.text)["proximity"] == "contact"


def _is_near(tip: Any, place: Any) -> bool:
    import numpy as np

    return np.linalg.norm(np.array(tip.content.matrix)[:3, 3] - place) < NEAR_ENOUGH_MM


def _move(client: Any, place: Any, speed_mm_s: float) -> None:
    _do(client, "MoveTipTo", positionMm=place.tolist(), speedMmS=speed_mm_s)


def _do(client: Any, name: str, /, **arguments: Any) -> None:
    reply = client.send_command(name, arguments, TIMEOUT_S)
    if not reply.ok:
        raise SystemExit(f"{name} was refused: {reply.error}")


if __name__ == "__main__":
    sys.exit(main())
