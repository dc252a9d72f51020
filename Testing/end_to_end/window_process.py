"""The simulator's page as an application window, on a display in memory."""

from __future__ import annotations

import os
import subprocess
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

from rastrainer_simulator.ops.application_window import application_browser, application_command
from Testing.end_to_end.virtual_display import VirtualDisplay

TIMEOUT_S = 300.0
PATIENCE_MS = 1000 * TIMEOUT_S
# The moment, s, and the tick of each picture; the sounds that were played.
NOTE = """() => {
  window.pictures = [];
  const drawn = page.frames.drawn.bind(page.frames);
  page.frames.drawn = () => {
    pictures.push({ shown: Date.now() / 1000, tick: page.state.tick });
    drawn();
  };
  window.heard = [];
  const play = page.sounds.play.bind(page.sounds);
  page.sounds.play = (name, volume) => {
    heard.push(name);
    return play(name, volume);
  };
}"""


class WindowProcess:
    """What `rastrainer simulator --desktop` opens; ended by the `with` statement.

    Attributes:
        page: by which a test looks at it; it operates it by the display's keyboard and mouse.
        pid: of the browser.
    """

    def __init__(
        self,
        display: VirtualDisplay,
        url: str,
        code: str,
        folder: Path,
        size: tuple[int, int] = (1280, 720),
    ) -> None:
        profile = folder / "profile"
        profile.mkdir(parents=True)
        command = application_command(application_browser(), f"{url}/?desktop#code={code}", profile)
        width, height = size
        self._process = subprocess.Popen(
            [
                *(word for word in command if not word.startswith("--window-size")),
                *(f"--window-size={width},{height}", "--window-position=0,0"),
                "--remote-debugging-port=0",
            ],
            env={**os.environ, "DISPLAY": display.name},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self.pid = self._process.pid
        port = profile / "DevToolsActivePort"
        wait_until(lambda: port.exists() and port.read_text(), "the window")
        self._playwright = sync_playwright().start()
        address = f"http://127.0.0.1:{port.read_text().split()[0]}"
        browser = self._playwright.chromium.connect_over_cdp(address)
        (self.page,) = browser.contexts[0].pages
        self.page.set_default_timeout(PATIENCE_MS)
        self.page.wait_for_selector("body[data-scene][data-menu]")
        self.page.evaluate(NOTE)

    def __enter__(self) -> WindowProcess:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.kill()

    def pictures(self) -> list[dict]:
        """Return the moment, s, and the tick of each picture so far."""
        return self.page.evaluate("pictures")

    def heard(self) -> list[str]:
        """Return the names of the sounds that were played so far."""
        return self.page.evaluate("heard")

    def wait_for_tick(self, tick: int) -> None:
        """Wait until the page shows that tick, or a later one."""
        wait_until(lambda: self.page.evaluate("page.state.tick") >= tick, "a picture of the tick")

    def kill(self) -> None:
        """End it as a crash would; a second time changes nothing."""
        if self._process.poll() is None:
            self._process.kill()
            self._process.wait()
            self._playwright.stop()


def wait_until(condition, what: str, patience_s: float = TIMEOUT_S) -> None:
    give_up = time.monotonic() + patience_s
    while not condition():
        assert time.monotonic() < give_up, f"{what} never came"
        time.sleep(0.01)
