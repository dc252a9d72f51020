"""Tests a connection once, without touching the scene."""

from __future__ import annotations

import math

from rastrainer.igtl.client import Client, LinkError
from rastrainer.protocol import PROTOCOL_VERSION, CommandName, Device
from rastrainer.slicer.heartbeat import LinkObservation, LinkStatus, judge


def probe(host: str, port: int, timeoutS: float = 2.0) -> LinkStatus:
    """Greet the simulator, wait for one heartbeat, and return what was found, in words."""
    address = f"{host}:{port}"
    try:
        client = Client(host, port, timeout=timeoutS)
    except LinkError:
        return judge(LinkObservation(address, isWanted=True))
    with client:
        try:
            hello = {"protocolVersion": PROTOCOL_VERSION, "client": "connection test"}
            client.send_command(CommandName.HELLO, hello, timeoutS)
            heartbeat = client.wait_for(Device.SIM_SERVER, timeout=timeoutS)
        except LinkError:
            return judge(LinkObservation(address, isWanted=True, isOpen=True, silenceS=math.inf))
    return judge(
        LinkObservation(
            address,
            isWanted=True,
            isOpen=True,
            isHeard=True,
            peerVersion=getattr(heartbeat.content, "subcode", 0),
        )
    )
