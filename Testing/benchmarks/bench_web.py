"""The costs of the browser page: bytes, triangles, draw calls, memory, and the delay to the
pixel."""

import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from playwright.sync_api import CDPSession, Page, Playwright, sync_playwright

from rastrainer.igtl.client import Client
from rastrainer.protocol import PROTOCOL_VERSION
from Testing.benchmarks.row import row
from Testing.end_to_end.lab import WITHOUT_GRAPHICS, Place
from Testing.web.chromium import enter_headset, launch, open_page

DIST = Path(__file__).parents[2] / "RASTrainerSimulatorServer" / "web" / "dist"
PAGE_FILES = ("index.html", "page.css", "page.js")
HEADSET = "metaQuest2"
KB = 1024.0
WARM_UP_S = 60
LONG_S = 600
# The browser continues to compile frequent code for minutes, and the compiled code is in the heap,
# too; without that, what grows is the page's own.
UNCOMPILED = "--js-flags=--no-sparkplug --no-maglev --no-opt"
SAMPLES = 11
# The page continues meanwhile: the least of several samples is nearest to what it retains.
LOOKS = 5
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
# A picture is drawn in several passes: of the camera and its inset, or of both eyes.
COUNT_A_PICTURE = """async () => {
  const { info } = page.stage.renderer;
  info.autoReset = false;
  page.isDue = true;
  await frames_(4);
  const begin = info.render.frame;
  let picture;
  do {
    info.reset();
    page.isDue = true;
    await frames_(1);
    picture = [info.render.triangles, info.render.calls];
  } while (picture[1] === 0 && info.render.frame < begin + 50);
  info.autoReset = true;
  return picture;
}"""


def rows(quick: bool) -> list[dict]:
    """Return the rows `web.*`."""
    packed = sum((DIST / f"{name}.br").stat().st_size for name in PAGE_FILES) / KB
    found = [row("web.page compressed", [packed], "kB")]
    with sync_playwright() as playwright:
        with _page(playwright) as (place, page):
            found += _picture(page, "page")
            found.append(_bytes(page, 3 if quick else 10))
            found.append(_delay(place, page, 5 if quick else 40))
        with _page(playwright, HEADSET) as (_place, page):
            found += _picture(page, "headset")
        found += _heaps(playwright, 5 if quick else 60)
    return found


def long_rows() -> list[dict]:
    """Return what takes minutes to measure: whether the heap grows."""
    with sync_playwright() as playwright:
        return _heaps(playwright, LONG_S)


@contextmanager
def _page(
    playwright: Playwright, headset: str = "", *arguments: str
) -> Iterator[tuple[Place, Page]]:
    """Open the page in a browser, at its own simulator, in a trial."""
    with tempfile.TemporaryDirectory() as folder:
        browser = launch(playwright, *arguments)
        with (
            Place(Path(folder), limits=WITHOUT_GRAPHICS) as place,
            Client(port=place.simulator.port) as client,
        ):
            page = open_page(browser, place.url, place.code, headset)
            hello = {"protocolVersion": PROTOCOL_VERSION, "client": "bench"}
            client.send_command("Hello", hello)
            task = {"task": "task-1", "trainee": "bench", "mode": "desktop"}
            client.send_command("StartTask", task)
            page.wait_for_selector("body[data-scene=task-1][data-menu='']")
            if headset:
                enter_headset(page)
            yield place, page
        browser.close()


def _picture(page: Page, name: str) -> list[dict]:
    triangles, calls = page.evaluate(COUNT_A_PICTURE)
    return [
        row(f"web.{name} triangles", [triangles], ""),
        row(f"web.{name} draw calls", [calls], ""),
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


def _heaps(playwright: Playwright, seconds: int) -> list[dict]:
    """Return the growth of heaps: the trend after each collection."""
    with (
        _page(playwright, "", UNCOMPILED) as (_place, page),
        _page(playwright, HEADSET, UNCOMPILED) as (_other, headset),
    ):
        sizes = _heap_sizes({"page": page, "headset": headset}, seconds)
    shares = np.linspace(0.0, 1.0, SAMPLES)
    return [
        row(f"web.{name} heap in {seconds} s", [np.polyfit(shares, kept, 1)[0]], "kB")
        for name, kept in sizes.items()
    ]


def _heap_sizes(pages: Mapping[str, Page], seconds: int) -> dict[str, list[float]]:
    """Return the size of the heap after each of `SAMPLES` collections, kB."""
    sessions = {name: page.context.new_cdp_session(page) for name, page in pages.items()}
    sizes: dict[str, list[float]] = {name: [] for name in pages}
    pages["page"].wait_for_timeout(1000 * WARM_UP_S)
    for _ in range(SAMPLES):
        for name, session in sessions.items():
            sizes[name].append(min(_heap_size(session) for _ in range(LOOKS)))
        pages["page"].wait_for_timeout(1000 * seconds / (SAMPLES - 1))
    return sizes


def _heap_size(session: CDPSession) -> float:
    session.send("HeapProfiler.collectGarbage")
    return session.send("Runtime.getHeapUsage")["usedSize"] / KB
