"""Make the picture of a teacher's board: python -m Testing.web.board_pictures.

Six seats that say what a simulator says; one of them has stopped answering.
"""

from __future__ import annotations

import dataclasses
import json
import tempfile
from collections.abc import Iterable
from pathlib import Path

from aiohttp import web
from playwright.sync_api import sync_playwright

from rastrainer.protocol import Phase
from rastrainer_simulator.net.views.messages import SUBPROTOCOL
from rastrainer_simulator.net.views.outgoing import seat as seat_text
from rastrainer_simulator.net.views.presenter import Seat
from rastrainer_simulator.ops.texts.english import ENGLISH
from rastrainer_simulator.ops.texts.texts import Texts
from rastrainer_simulator.state import TouchStage
from Testing.free_port import free_port
from Testing.simulator.board.conftest import BoardClient
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.web.chromium import launch

PICTURE = Path(__file__).parents[2] / "docs" / "pictures" / "board.png"
HOST, SIZE = "127.0.0.1", {"width": 1180, "height": 640}
WELCOME = json.dumps({"type": "welcome", "protocol": 1, "view": 1, "bodies": []})
KEY = "k" * 43
SAY = Texts(ENGLISH).say


def assignment(task: str, progress: str, reached: int) -> str:
    """Return where a trainee stands in a curriculum of six assignments."""
    summary = SAY("assignments.summary", reached=reached, count=6)
    next_ = SAY("assignments.next in brief", assignment=task, progress=progress)
    return f"{summary}. {next_}"


def seat(
    trainee: str,
    task: str,
    state: tuple[Phase, TouchStage, int, int],
    **others: object,
) -> str:
    """Return what a seat says; its state is phase, touch, touched points and time, s."""
    phase, touch, touched, elapsed = state
    known = {"trainee": trainee, "task": task, "count": 15 if task else 0, "slicer": True}
    known["holder"] = "gamepad" if task else ""
    return seat_text(
        **dataclasses.asdict(Seat(**{**known, **others})),
        phase=phase.value,
        touched=touched,
        rejected=0,
        elapsed=elapsed,
        touch=touch.value,
    )


def seats() -> dict[str, str]:
    """Return what each seat says, by its name."""
    far, warning = (Phase.RUNNING, TouchStage.FAR), SAY("warning.elsewhere")
    paused, scored = (Phase.PAUSED, TouchStage.FAR), (Phase.SCORED, TouchStage.FAR)
    first, fifth = assignment("Task 2", "1 / 2", 1), assignment("Task 5", "2 / 3", 4)
    return {
        "Window 1": seat("T004", "Task 2", (*far, 9, 71), score=82.0, assignments=first),
        "Window 2": seat(
            "T011",
            "Task 4",
            (Phase.RUNNING, TouchStage.ELSEWHERE, 3, 34),
            score=58.0,
            warnings=(warning,),
        ),
        "Window 3": seat("T007", "Task 1", (*paused, 12, 95), screen="Task 1"),
        "Headset": seat(
            "T002", "", (*scored, 0, 0), score=91.0, screen="T002: Task 5", assignments=fifth
        ),
        "Seminar room": seat(
            "", "", (Phase.IDLE, TouchStage.FAR, 0, 0), slicer=False, screen=SAY("start.title")
        ),
        "Back room": seat("T009", "Task 3", (*far, 6, 52), score=64.0),
    }


async def serve(text: str) -> tuple[web.AppRunner, int]:
    """Serve a seat; return its server and its port."""

    async def stream(request: web.Request) -> web.WebSocketResponse:
        socket = web.WebSocketResponse(protocols=(SUBPROTOCOL,))
        await socket.prepare(request)
        await socket.receive()
        await socket.send_str(WELCOME)
        await socket.send_str(text)
        await socket.receive()
        return socket

    async def pair(_request: web.Request) -> web.Response:
        return web.json_response({"key": KEY})

    app = web.Application()
    app.add_routes([web.post("/pair", pair), web.get("/stream", stream)])
    runner, port = web.AppRunner(app, access_log=None, shutdown_timeout=0.1), free_port()
    await runner.setup()
    await web.TCPSite(runner, HOST, port).start()
    return runner, port


def take_picture(board: BoardClient, stopped: Iterable[web.AppRunner]) -> None:
    """Picture the board once all seats are shown, and those that have stopped are known to have."""
    with sync_playwright() as driver:
        browser = launch(driver)
        page = browser.new_page(viewport=SIZE, device_scale_factor=1)
        page.goto(f"{board.url}/#code={board.server.code.code}")
        page.wait_for_selector("#seats > li:nth-child(6)")
        page.get_by_text("T009").wait_for()
        for runner in stopped:
            board.thread.run(runner.cleanup())
        page.get_by_text("does not answer").first.wait_for()
        page.screenshot(path=PICTURE, full_page=True)
        browser.close()


def main() -> None:
    """Make the picture."""
    with tempfile.TemporaryDirectory() as folder, LoopThread() as thread:
        board = BoardClient(thread, Path(folder) / "teacher")
        runners = []
        for name, text in seats().items():
            runner, port = thread.run(serve(text))
            runners.append(runner)
            values = {"name": name, "address": f"http://{HOST}:{port}", "code": "000000"}
            status, answer = board.ask("/seats", "POST", **values)
            assert status == 200, answer
        take_picture(board, runners[-1:])
        board.close()
        for runner in runners[:-1]:
            thread.run(runner.cleanup())


if __name__ == "__main__":
    main()
