"""Make the pictures of a teacher's board: python -m Testing.web.board_pictures.

Six seats that answer as simulators do, of which one has stopped answering, and a class of twelve
virtual trainees.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterable
from pathlib import Path

from aiohttp import web
from playwright.sync_api import sync_playwright

from rastrainer.number_text import with_units
from rastrainer.protocol import Phase
from rastrainer_simulator.board.class_table import ClassReader, Standings
from rastrainer_simulator.flow.session.assigned_training import AssignmentTexts
from rastrainer_simulator.presentation.messages import SUBPROTOCOL, SeatNews, message_text
from rastrainer_simulator.state import TouchStage
from rastrainer_simulator.texts.texts import Texts
from Testing.free_port import free_port
from Testing.pictures import keep_picture
from Testing.simulator.board.class_study import play_class
from Testing.simulator.board.conftest import BoardClient
from Testing.simulator.net.igtl.servers import HOST, LoopThread
from Testing.web.chromium import launch

FOLDER = Path(__file__).parents[2] / "docs" / "pictures"
SIZE, WIDE = {"width": 1180, "height": 640}, {"width": 1300, "height": 640}
SAY = Texts().say


def assignments(found: Standings, trainee: str) -> str:
    """Return where a trainee stands, as the seat reports it."""
    words = AssignmentTexts(Texts(), lambda task: SAY(f"task.{task}"), str.capitalize)
    return words.in_brief(found[trainee].message(trainee))


def seat(
    trainee: str, task: str, state: tuple[Phase, TouchStage, int, int], **others: object
) -> str:
    """Return what a seat reports; its state is phase, touch, touched points and time, s."""
    phase, touch, touched, elapsed = state
    known = {"trainee": trainee, "task": task, "count": 15 if task else 0, "slicer": True}
    known["holder"] = "gamepad" if task else ""
    trial = {"phase": phase, "touched": touched, "rejected": 0, "elapsed_s": elapsed}
    return with_units(message_text(SeatNews(**{**known, **others}, **trial, touch=touch)))


def seats(found: Standings) -> dict[str, str]:
    """Return what each seat reports, by its name; two report where their trainees stand."""
    far, warning = (Phase.RUNNING, TouchStage.FAR), SAY("warning.elsewhere")
    paused, scored = (Phase.PAUSED, TouchStage.FAR), (Phase.SCORED, TouchStage.FAR)
    first, fifth = assignments(found, "T004"), assignments(found, "T002")
    return {
        "Window 1": seat("T004", "Task 4", (*far, 9, 71), score=82.0, assignments=first),
        "Window 2": seat(
            "T011",
            "Task 4",
            (Phase.RUNNING, TouchStage.ELSEWHERE, 3, 34),
            score=58.0,
            warnings=(warning,),
        ),
        "Window 3": seat("T007", "Task 1", (*paused, 12, 95), screen="Task 1"),
        "Headset": seat(
            "T002", "", (*scored, 0, 0), score=91.0, screen="T002: Task 4", assignments=fifth
        ),
        "Seminar room": seat(
            "", "", (Phase.IDLE, TouchStage.FAR, 0, 0), slicer=False, screen=SAY("start.title")
        ),
        "Back room": seat("T009", "Task 3", (*far, 6, 52), score=64.0),
    }


async def serve_seat(reported: str) -> tuple[web.AppRunner, int]:
    """Serve a seat that pairs with any board and reports one state; return server and port."""

    async def pair(_request: web.Request) -> web.Response:
        return web.json_response({"key": "k" * 43})

    async def stream(request: web.Request) -> web.WebSocketResponse:
        socket = web.WebSocketResponse(protocols=(SUBPROTOCOL,))
        await socket.prepare(request)
        await socket.receive()
        welcome = {"type": "welcome", "protocol": 1, "view": 1, "bodies": []}
        await socket.send_str(json.dumps(welcome))
        await socket.send_str(reported)
        await socket.receive()
        return socket

    app = web.Application()
    app.add_routes([web.post("/pair", pair), web.get("/stream", stream)])
    runner, port = web.AppRunner(app, access_log=None, shutdown_timeout=0.1), free_port()
    await runner.setup()
    await web.TCPSite(runner, HOST, port).start()
    return runner, port


def take_picture(board: BoardClient, stopped: Iterable[web.AppRunner]) -> None:
    """Picture the board once all seats are shown, and those that have stopped are known."""
    with sync_playwright() as driver:
        browser = launch(driver)
        page = browser.new_page(viewport=SIZE, device_scale_factor=1)
        page.goto(f"{board.url}/#code={board.server.code.code}")
        page.wait_for_selector("#seats > li:nth-child(6)")
        page.locator("#seats").get_by_text("T009").wait_for()
        for runner in stopped:
            board.thread.run(runner.cleanup())
        page.get_by_text("does not answer").first.wait_for()
        page.get_by_role("cell", name="Window 1").wait_for()
        top = page.locator("#class").bounding_box()["y"]
        clip = {"x": 0, "y": 0, "width": SIZE["width"], "height": top - 16}
        keep_picture(page.screenshot(full_page=True, clip=clip), FOLDER / "board.webp")
        page.set_viewport_size(WIDE)
        box = page.locator("#class").bounding_box()
        clip = {"x": 0, "y": box["y"] - 16, "width": WIDE["width"], "height": box["height"] + 32}
        keep_picture(page.screenshot(full_page=True, clip=clip), FOLDER / "class.webp")
        browser.close()


def main() -> None:
    """Make the pictures."""
    with tempfile.TemporaryDirectory() as folder, LoopThread() as thread:
        study = Path(folder) / "study.db"
        play_class(study, [f"T{number:03}" for number in range(1, 13)], 30)
        reader = ClassReader(study)
        found = reader.read()
        reader.close()
        board = BoardClient(thread, Path(folder) / "teacher", study)
        runners = []
        for name, text in seats(found).items():
            runner, port = thread.run(serve_seat(text))
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
