"""`rastrainer doctor`: one screen of checks of this computer, each with a remedy."""

from __future__ import annotations

import argparse
import json
import os
import platform
import re
import shutil
import socket
import sys
import tempfile
from collections.abc import Iterator
from importlib import import_module, metadata
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.protocol import DEFAULT_HOST
from rastrainer_simulator.assets import page_folder
from rastrainer_simulator.input.gamepads import NoGamepadsError, start_sdl
from rastrainer_simulator.net.listener import listening_socket
from rastrainer_simulator.ops.application_window import application_browser
from rastrainer_simulator.ops.processes import has_display
from rastrainer_simulator.ops.system_paths import config_folder, log_folder

OK, WARNING, PROBLEM = "ok", "warning", "problem"
"""A warning means that a feature is missing, a problem that training is impossible."""
Answers = Iterator[tuple[str, str]]
"""Verdicts, each with a sentence about the finding."""


def check_computer(arguments: argparse.Namespace) -> int:
    findings = [
        {"check": title, "verdict": verdict, "sentence": sentence, "remedy": remedy}
        for title, test, advice in CHECKS
        for verdict, sentence in test(arguments)
        for remedy in ["" if verdict == OK else advice]
    ]
    if arguments.json:
        print(json.dumps(findings, indent=2))
    else:
        for each in findings:
            print(f"{each['verdict']:<8} {each['check']:<10} {each['sentence']}")
            if each["remedy"]:
                print(f"{'':<19} → {each['remedy']}")
    return 1 if any(each["verdict"] == PROBLEM for each in findings) else 0


NEEDED = (
    *("aiohttp", "jinja2", "matplotlib", "numpy", "psycopg", "pygame-ce", "python-fcl", "scipy"),
    *("trustme", "vtk", "yourdfpy"),
)
FASTER = () if sys.platform == "win32" else ("fastcrc", "pin")
MODULES = {"pin": "pinocchio", "pygame-ce": "pygame", "python-fcl": "fcl"}
MODULES |= {"vtk": "vtkmodules.vtkCommonCore"}
"""Modules whose names differ from their packages."""


def check_python(_arguments: argparse.Namespace) -> Answers:
    yield OK, f"Python {platform.python_version()} at {sys.executable}."
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    loaded = []
    for package in (*NEEDED, *FASTER):
        try:
            import_module(MODULES.get(package, package))
            loaded.append(f"{package} {metadata.version(package)}")
        except Exception as error:  # a broken library may raise anything
            verdict = WARNING if package in FASTER else PROBLEM
            yield verdict, f"The package {package} cannot be loaded ({error})."
    yield OK, f"Packages that can be loaded: {', '.join(loaded)}."
    try:
        from rastrainer_simulator.robot.kinematics import kinematics_name

        yield OK, f"{kinematics_name()} computes the robot's kinematics."
    except (ImportError, InputError) as error:
        yield PROBLEM, f"The robot's kinematics cannot be computed: {error}"


def check_window(_arguments: argparse.Namespace) -> Answers:
    if not has_display():
        yield WARNING, "There is no display, so no window can open; other computers can show it."
    elif (browser := application_browser()) is None:
        yield WARNING, "There is no Chrome, Chromium or Edge: your usual browser shows the page."
    else:
        yield OK, f"{browser} shows the page in a window of its own."


def check_page(_arguments: argparse.Namespace) -> Answers:
    if folder := page_folder():
        yield OK, f"The page for browsers and headsets is in {folder}."
    else:
        yield WARNING, "The page for browsers and headsets is not built."


KEYBOARD = "The keyboard does everything a gamepad does."


def check_gamepad(_arguments: argparse.Namespace) -> Answers:
    try:
        pygame, controller = start_sdl()
    except NoGamepadsError as error:
        yield WARNING, f"Gamepads cannot be read: {error}. {KEYBOARD}"
        return
    count = pygame.joystick.get_count()
    for index in range(count):
        if controller.is_controller(index):
            yield OK, f"{controller.Controller(index).name} is plugged in."
        else:
            name = pygame.joystick.Joystick(index).get_name()
            yield WARNING, f"The layout of {name} is not known. {KEYBOARD}"
    if not count:
        yield WARNING, f"No gamepad is plugged in, or this user may read none. {KEYBOARD}"
    controller.quit()
    pygame.display.quit()


def check_ports(arguments: argparse.Namespace) -> Answers:
    both = ((PROBLEM, "OpenIGTLink", arguments.port), (WARNING, "the views", arguments.view_port))
    for verdict, what, port in both:
        try:
            listening_socket(socket.AF_INET, (DEFAULT_HOST, port)).close()
            yield OK, f"Port {port} for {what} is free."
        except (OSError, OverflowError) as error:
            reason = (getattr(error, "strerror", "") or str(error)).lower()
            yield verdict, f"Port {port} for {what} cannot be used: {reason.rstrip('.')}."


EXTENSION = "SlicerOpenIGTLink"
PLACES = {
    "linux": "~:~/Applications:~/Downloads:/opt:/usr/local",
    "darwin": "/Applications:~/Applications",
    "win32": "$LOCALAPPDATA;$ProgramData;$ProgramFiles",
}
"""Where Slicer usually is; on Windows perhaps in a folder of its publisher."""


def _folders(names: str) -> list[Path]:
    # Unlike Path's, this leaves ~ as it is where there is no home folder.
    split = names.split(os.pathsep)
    return [Path(os.path.expandvars(os.path.expanduser(name))) for name in split]  # noqa: PTH111


def check_slicer(_arguments: argparse.Namespace) -> Answers:
    named, on_path = os.environ.get("SLICER_HOME"), shutil.which("Slicer")
    candidates = [Path(named)] if named else []
    candidates += [Path(on_path).resolve().parent] if on_path else []
    for place in _folders(PLACES.get(sys.platform, "~")):
        for pattern in ("Slicer*", "slicer.org/Slicer*", "NA-MIC/Slicer*"):
            candidates += sorted(place.glob(pattern))
    program = {"win32": "Slicer.exe", "darwin": "MacOS/Slicer"}.get(sys.platform, "Slicer")
    folders = [one / "Contents" if one.suffix == ".app" else one for one in candidates]
    slicers = [folder for folder in dict.fromkeys(folders) if (folder / program).is_file()]
    if not slicers:
        yield WARNING, "3D Slicer is not found; nothing is wrong where it runs elsewhere."
        return
    for folder in slicers:
        version = re.search(r"Slicer[- ](\d+)\.(\d+)", str(folder))
        if version is None or tuple(map(int, version.groups())) >= (5, 10):
            yield OK, f"3D Slicer is in {folder}."
        else:
            yield WARNING, f"3D Slicer in {folder} is older than the module was made for."
    (users,) = _folders("$APPDATA" if sys.platform == "win32" else "~/.config")
    bases = [users / "slicer.org", users / "NA-MIC"]
    bases += [base for each in slicers for base in (each / "slicer.org", each / "Extensions", each)]
    found = [path for base in bases for path in base.glob(f"Extensions-*/{EXTENSION}")]
    if found:
        yield OK, f"{EXTENSION} is in {found[0]}."
    else:
        yield WARNING, f"{EXTENSION} is missing: install it in Slicer's Extensions Manager."


PROBLEM_MB, WARNING_MB = 100.0, 1000.0
"""A journal of a long trial takes 6 MB."""


def check_disk(arguments: argparse.Namespace) -> Answers:
    """Check the folders that are written to, or those that they will be made in."""
    config = arguments.config
    settings, logs = (config, config / "logs") if config else (config_folder(), log_folder())
    for what, folder in (("Trials", arguments.records), ("Settings", settings), ("Logs", logs)):
        try:
            parents = (folder, *folder.absolute().parents)
            existing = next(each for each in parents if os.path.exists(each))  # noqa: PTH110
            with tempfile.TemporaryFile(dir=existing):
                free_mb = shutil.disk_usage(existing).free / 1e6
        except OSError as error:
            yield PROBLEM, f"{what}: {folder} cannot be written to: {error.strerror}."
            continue
        verdict = PROBLEM if free_mb < PROBLEM_MB else WARNING if free_mb < WARNING_MB else OK
        yield verdict, f"{what}: {folder} can be written to; {free_mb:,.0f} MB are free."


PIP = f"{sys.executable} -m pip install"
CHECKS = (
    ("python", check_python, f"Install the package again: {PIP} --force-reinstall PACKAGE"),
    ("window", check_window, "Install one of them, or open the page on another computer: --lan"),
    ("browser", check_page, "Build it: make page"),
    (
        "gamepad",
        check_gamepad,
        "Plug one in. Switch a Logitech F310 to XInput (X on its back). On Linux, add yourself to "
        "the group input (sudo usermod -aG input $USER), and log in again.",
    ),
    ("ports", check_ports, "End what uses it, or choose another (for OpenIGTLink in Slicer, too)."),
    (
        "slicer",
        check_slicer,
        "Get Slicer 5.10 or newer from download.slicer.org, or set SLICER_HOME.",
    ),
    ("disk", check_disk, "Free some space there and allow writing, or choose another folder."),
)
"""Title, test and remedy of each check."""
