"""Simulators that only repeat what a real one has sent to a board, each with its own timing."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import Sequence
from multiprocessing.connection import Connection

import aiohttp
from aiohttp import web

from rastrainer_simulator.presentation.messages import SUBPROTOCOL
from Testing.end_to_end.simulator_process import ViewedSimulator
from Testing.simulator.board.seat_double import serve_seat
from Testing.simulator.net.views.served import HELLO

Recording = Sequence[tuple[float, str]]
"""Time since the first, s, and the message."""


async def recorded(simulator: ViewedSimulator, seconds: float) -> Recording:
    """Return what a real simulator sends to a board within some seconds."""
    async with aiohttp.ClientSession() as session:
        body = {"code": simulator.code, "role": "board"}
        answer = await session.post(f"{simulator.url}/pair", json=body)
        key = (await answer.json())["key"]
        headers = {"Authorization": f"Bearer {key}"}
        stream = await session.ws_connect(
            f"{simulator.url}/stream", protocols=[SUBPROTOCOL], headers=headers
        )
        await stream.send_str(json.dumps({**HELLO, "kind": "board"}))
        found: list[tuple[float, str]] = []
        begin = time.monotonic()
        while (now := time.monotonic() - begin) < seconds:
            try:
                message = await asyncio.wait_for(stream.receive(), seconds - now)
            except asyncio.TimeoutError:
                break
            if '"type":"seat"' in message.data:
                found.append((time.monotonic() - begin, message.data))
        await stream.close()
    return found


def repeat(count: int, recording: Recording, pipe: Connection) -> None:
    """Serve a number of seats; report the ports, and at the end when each message was sent.

    Each message has its number as `rejected`; times are `time.time`, s, by seat and number.
    """
    asyncio.run(_repeat(count, recording, pipe))


async def _repeat(count: int, recording: Recording, pipe: Connection) -> None:
    sent: dict[tuple[int, int], float] = {}
    served = [await serve_seat(_talker(seat, count, recording, sent)) for seat in range(count)]
    pipe.send([port for _runner, port in served])
    while not pipe.poll():
        await asyncio.sleep(0.1)
    pipe.send(sent)


def _talker(seat: int, count: int, recording: Recording, sent: dict):
    async def say(socket: web.WebSocketResponse) -> None:
        # Classes do not begin at the same time.
        await asyncio.sleep(seat / count)
        number = 0
        while not socket.closed:
            begin = time.monotonic()
            for due, text in recording:
                await asyncio.sleep(max(0.0, begin + due - time.monotonic()))
                number += 1
                sent[seat, number] = time.time()
                await socket.send_str(json.dumps({**json.loads(text), "rejected": number}))

    return say
