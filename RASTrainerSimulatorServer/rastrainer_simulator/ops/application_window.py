"""The page of the views as an application of this computer: a browser without bars and tabs."""

from __future__ import annotations

import asyncio
import contextlib
import os
import shutil
import subprocess
import sys
import tempfile
import webbrowser
from collections.abc import Callable
from pathlib import Path

from rastrainer.files.writing import make_private_folder, write_text
from rastrainer.home_folder import home_folder
from rastrainer.journal.folder import lock, open_lock_file

PROGRAMS = (
    *("google-chrome-stable", "google-chrome", "chromium", "chromium-browser"),
    *("microsoft-edge-stable", "microsoft-edge", "chrome", "msedge"),
)
"""Browsers that can show a page as an application, by their names on the path."""
PLACES = {
    "darwin": (
        "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
        "/Applications/Chromium.app/Contents/MacOS/Chromium",
        "/Applications/Microsoft Edge.app/Contents/MacOS/Microsoft Edge",
    ),
    "win32": (
        r"%ProgramFiles%\Google\Chrome\Application\chrome.exe",
        r"%ProgramFiles(x86)%\Google\Chrome\Application\chrome.exe",
        r"%LocalAppData%\Google\Chrome\Application\chrome.exe",
        r"%ProgramFiles(x86)%\Microsoft\Edge\Application\msedge.exe",
        r"%ProgramFiles%\Microsoft\Edge\Application\msedge.exe",
    ),
}
"""Where they are on systems whose path does not have them."""
OPTIONS = (
    *("--no-first-run", "--no-default-browser-check", "--window-size=1280,720"),
    *("--disable-extensions", "--disable-sync", "--disable-background-networking"),
    *("--disable-component-update", "--disable-features=Translate"),
    # Sounds begin before the first click; no question about a keyring.
    "--autoplay-policy=no-user-gesture-required",
    *("--password-store=basic", "--use-mock-keychain"),
)
WITHOUT_GRAPHICS = (
    *("--ignore-gpu-blocklist", "--use-gl=angle", "--use-angle=gl-egl"),
    "--disable-gpu-compositing",
)
"""Mesa then draws on the processor, several times faster than Chromium's own software renderer."""
AS_ROOT = ("--no-sandbox", "--test-type")
"""Chromium refuses to run as root otherwise; the second spares a bar that says so."""
NICENESS = "10"
"""A browser that draws on the processor leaves it to the control loop first."""
ENDING_S, LOOK_S = 5.0, 0.1
LOCK_NAME = "in-use.lock"
"""Locked by the simulator whose window has the folder, until its process ends."""
GONE = (
    "continues without its window, which ended with status {status}: open {url} in a browser, and "
    "type the pairing code {code}"
)
NO_BROWSER = (
    "opens no window: there is no Chrome, Chromium, Edge or other browser. Install one, or open "
    "{url} on another computer with --lan; the pairing code is {code}"
)
_REDIRECTION = """<!doctype html>
<meta charset="utf-8">
<title>RASTrainer</title>
<script>location.replace("{url}/?desktop#code={code}");</script>
"""


def application_browser() -> Path | None:
    """Return a browser that can show a page as an application; None without one."""
    names = filter(None, map(shutil.which, PROGRAMS))
    places = (os.path.expandvars(place) for place in PLACES.get(sys.platform, ()))
    return next((path for path in map(Path, (*places, *names)) if path.is_file()), None)


def application_command(browser: Path, page: str, profile: Path) -> list[str]:
    """Return the command that shows a page as an application, with a separate profile."""
    command = [str(browser), *OPTIONS, f"--app={page}", f"--user-data-dir={profile}"]
    if sys.platform != "win32" and os.geteuid() == 0:
        command += AS_ROOT
    # On Linux, the driver's file tells whether there is a graphics processor.
    if not sys.platform.startswith("linux") or any(Path("/dev/dri").glob("renderD*")):
        return command
    niceness = [] if shutil.which("nice") is None else ["nice", "-n", NICENESS]
    return [*niceness, *command, *WITHOUT_GRAPHICS]


def remove_unused_folders(parent: Path) -> None:
    """Remove the windows' folders that killed simulators have left."""
    for file in parent.glob(f"*/{LOCK_NAME}"):
        with contextlib.suppress(OSError):
            descriptor = open_lock_file(file)
            try:
                lock(descriptor)
            finally:
                os.close(descriptor)
            shutil.rmtree(file.parent, ignore_errors=True)


class ApplicationWindow:
    """Shows the page of one simulator in a separate browser with a separate profile."""

    def __init__(self, url: str, code: str) -> None:
        """`url` is the address of the views, `code` pairs a view."""
        self._url = url
        self._code = code
        self._process: asyncio.subprocess.Process | None = None
        self._folder: Path | None = None
        self._lock = -1

    async def run(self, on_closed: Callable[[], None], announce: Callable[[str], None]) -> None:
        """Open the window and wait for its end.

        `on_closed` is called if its user has closed it. If it ended in any other way, or if the
        usual browser shows the page, the simulator stays; `announce` says how to come back.
        """
        browser = application_browser()
        # Ubuntu's Chromium sees neither hidden folders nor temporary files.
        parent = home_folder() / "RASTrainer" / "window"
        make_private_folder(parent)
        remove_unused_folders(parent)
        self._folder = Path(tempfile.mkdtemp(dir=parent))
        self._lock = open_lock_file(self._folder / LOCK_NAME)
        # Without locks, as on some network disks, no folder counts as unused.
        with contextlib.suppress(OSError):
            lock(self._lock)
        # A page that leads to ours: others can read a command line, but not this file.
        page = self._folder / "open.html"
        write_text(page, _REDIRECTION.format(url=self._url, code=self._code), is_private=True)
        if browser is None:
            if not webbrowser.open(page.as_uri()):
                announce(NO_BROWSER.format(url=self._url, code=self._code))
            return
        self._process = await asyncio.create_subprocess_exec(
            # The window ends when this process does, even by a crash, on Linux.
            *([] if shutil.which("setpriv") is None else ["setpriv", "--pdeathsig", "TERM"]),
            *application_command(browser, page.as_uri(), page.parent / "profile"),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        status = await self._process.wait()
        if status == 0:
            on_closed()
        else:
            announce(GONE.format(status=status, url=self._url, code=self._code))

    async def close(self) -> None:
        process = self._process
        if process is not None and process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                process.terminate()
            try:
                await asyncio.wait_for(process.wait(), ENDING_S)
            except asyncio.TimeoutError:
                process.kill()
                await process.wait()
        if self._lock >= 0:
            os.close(self._lock)
            self._lock = -1
        # A browser's other processes write until they have noticed the end of the first.
        for _ in range(round(ENDING_S / LOOK_S)):
            if self._folder is None or not self._folder.exists():
                break
            shutil.rmtree(self._folder, ignore_errors=True)
            await asyncio.sleep(LOOK_S)
