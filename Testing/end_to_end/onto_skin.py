"""The way of the tip over OpenIGTLink: to a place in the air, and onto the skin."""

from __future__ import annotations

import json

import numpy as np

from rastrainer.commands import CommandName
from rastrainer.igtl.client import Client
from rastrainer.igtl.message import Message
from rastrainer.protocol import DeviceName, Proximity
from rastrainer_simulator.virtual.scripted_trial import send

SINK_MM = 1.0
"""How far below the skin the tip is sent: it stops on the skin."""
TIMEOUT_S = 120.0


def lowered(place: np.ndarray, center: np.ndarray) -> list[float]:
    """Return where to send the tip for a place on the skin, World, mm."""
    inward = (center - place) / np.linalg.norm(center - place)
    return (place + SINK_MM * inward).tolist()


def carry_to(client: Client, place: np.ndarray, near_mm: float = 1.5) -> None:
    """Have the tip carried to a place (3,) float, World, mm, until it is near there."""

    def is_there(tip: Message) -> bool:
        return np.linalg.norm(np.array(tip.content.matrix)[:3, 3] - place) < near_mm

    send(client, CommandName.MOVE_TIP_TO, {"positionMm": place.tolist(), "speedMmS": 400})
    client.wait_for(DeviceName.TOOL_TIP_TO_WORLD, is_there, TIMEOUT_S)


def lower_onto_skin(client: Client, place: np.ndarray, center: np.ndarray) -> None:
    """Lower the tip onto a place of the skin, with `center` beneath: (3,) float, World, mm."""
    arguments = {"positionMm": lowered(place, center), "speedMmS": 300}
    send(client, CommandName.MOVE_TIP_TO, arguments)
    client.wait_for(DeviceName.SIM_STATE, is_in_contact, TIMEOUT_S)


def is_in_contact(state: Message) -> bool:
    """Return whether a SimState reports contact of the tool with the head."""
    return json.loads(state.content.text)["proximity"] == Proximity.CONTACT.value
