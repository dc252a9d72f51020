"""What the browser page costs: bytes, triangles, draw calls, memory, and the way to the pixel."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from rastrainer.igtl.client import Client
from rastrainer.protocol import PROTOCOL_VERSION
from Testing.benchmarks.row import row
from Testing.web.chromium import launch, open_page
from Testing.web.place import Place

DIST = Path(__file__).parents[2] / "RASTrainerSimulatorServer" / "web" / "dist"
PAGE_FILES = ("index.html", "page.css", "page.js")
KB = 1024.0
# The state is drawn one and a half periods of the stream after it has come, to be smooth.
WAIT_FOR_CAMERA = """(camera) => new Promise((done) => {
  const look = () => {
    if (page.state.camera === camera) {
      requestAnimationFrame(() => {
        page.stage.renderer.getContext().finish();
        done(Date.now());
      });
    } else requestAnimationFrame(look);
  };
  look();
})"""


def rows(quick: bool) -> list[dict]:
    """Return the rows `web.*`."""
    packed = sum((DIST / f"{name}.br").stat().st_size for name in PAGE_FILES) / KB
    found = [row("web.page compressed", [packed], "kB")]
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = launch(playwright)
        with Place(Path(folder)) as place:
            page = open_page(browser, place.simulator.url, place.simulator.code)
            found += _scene(page)
            found.append(_bytes(page, 3 if quick else 10))
            found.append(_delay(place, page, 5 if quick else 40))
            found.append(_heap(page, 5 if quick else 600))
        browser.close()
    return found


def _scene(page: Page) -> list[dict]:
    page.evaluate("page.isDue = true; frames_(2)")
    counted = page.evaluate(
        """(() => { const { renderer, scene } = page.stage;
          renderer.render(scene, page.flat.camera);
          const { triangles, calls } = renderer.info.render;
          return [triangles, calls]; })()"""
    )
    return [
        row("web.triangles", [counted[0]], ""),
        row("web.draw calls", [counted[1]], ""),
    ]


def _bytes(page: Page, seconds: int) -> dict:
    """Count what the stream brings to one view."""
    sizes = []
    session = page.context.new_cdp_session(page)
    session.send("Network.enable")
    session.on(
        "Network.webSocketFrameReceived",
        lambda event: sizes.append(len(event["response"]["payloadData"].encode())),
    )
    begin = time.monotonic()
    page.wait_for_timeout(1000 * seconds)
    passed = time.monotonic() - begin
    session.detach()
    return row("web.stream per view", [sum(sizes) / KB / passed], "kB/s")


def _delay(place: Place, page: Page, count: int) -> dict:
    """Measure from the command that changes the camera to the picture drawn with it."""
    delays = []
    with Client(port=place.simulator.port) as client:
        hello = {"protocolVersion": PROTOCOL_VERSION, "client": "bench"}
        client.send_command("Hello", hello)
        for index in range(count):
            camera = ("far", "close-up")[index % 2]
            page.evaluate(f"void (window.drawn = ({WAIT_FOR_CAMERA})('{camera}'))")
            sent = 1000.0 * time.time()
            client.send_command("SetCamera", {"camera": camera})
            delays.append(page.evaluate("window.drawn") - sent)
            page.wait_for_timeout(800)
    return row("web.change to pixel", delays, "ms")


def _heap(page: Page, seconds: int) -> dict:
    """Return what the heap has grown by after collections at both ends."""
    session = page.context.new_cdp_session(page)

    def used() -> float:
        session.send("HeapProfiler.collectGarbage")
        return session.send("Runtime.getHeapUsage")["usedSize"] / KB

    page.wait_for_timeout(2000)
    before = used()
    page.wait_for_timeout(1000 * seconds)
    return row(f"web.heap growth in {seconds} s", [used() - before], "kB")
