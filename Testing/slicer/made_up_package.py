"""Wheels, and a simulator that comes with a module, as small as a test needs them."""

from __future__ import annotations

import hashlib
import threading
import zipfile
from collections.abc import Mapping, Sequence
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import rastrainer
from rastrainer import __version__
from rastrainer.slicer.program.simulator_package import LOCK, WHEEL, SimulatorPackage

NOTHING = "# Nothing of others.\n"
OURS = (
    "__init__.py",
    "python_environment.py",
    "slicer/__init__.py",
    "slicer/program/__init__.py",
    "slicer/program/trim_packages.py",
)
"""Parts of the real wheel: they run a program on the packages of its folder, and trim them."""


def write_wheel(folder: Path, name: str, version: str, files: Mapping[str, str]) -> Path:
    """Write a wheel of these texts into a folder, which is made for it, and return its path."""
    folder.mkdir(parents=True, exist_ok=True)
    info = f"{name}-{version}.dist-info"
    texts = {
        **files,
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\n"
        "Tag: py3-none-any\n",
    }
    texts[f"{info}/RECORD"] = "".join(f"{path},,\n" for path in [*texts, f"{info}/RECORD"])
    path = folder / f"{name}-{version}-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as wheel:
        for place, text in texts.items():
            wheel.writestr(place, text)
    return path


def simulator_files(cli: str) -> dict[str, str]:
    """Return the files of a simulator whose command line has this text."""
    source = Path(rastrainer.__file__).parent
    ours = {f"rastrainer/{name}": (source / name).read_text(encoding="utf-8") for name in OURS}
    simulator = "rastrainer_simulator"
    empty = {f"{simulator}/__init__.py": "", f"{simulator}/cli/__init__.py": ""}
    return {**ours, **empty, f"{simulator}/cli/main.py": cli}


def lock_entry(package: Path, marker: str = "") -> str:
    """Return the line of a lock that fixes a wheel or sources, for where the marker holds."""
    name, version = package.name.removesuffix(".zip").split("-")[:2]
    digest = hashlib.sha256(package.read_bytes()).hexdigest()
    condition = f" ; {marker}" if marker else ""
    return f"{name}=={version}{condition} \\\n    --hash=sha256:{digest}\n"


def write_package(folder: Path, cli: str, lock: Sequence[str] = ()) -> SimulatorPackage:
    """Write what an installed module brings along: a wheel with its SHA-256, and a lock."""
    wheel = write_wheel(folder, "rastrainer", __version__, simulator_files(cli))
    assert wheel.name == WHEEL
    digest = hashlib.sha256(wheel.read_bytes()).hexdigest()
    (folder / f"{WHEEL}.sha256").write_text(f"{digest}  {WHEEL}\n", encoding="utf-8")
    (folder / LOCK).write_text("".join(lock) or NOTHING, encoding="utf-8")
    return SimulatorPackage(folder)


class PackageIndex:
    """Serves wheels as an index does; to be used in a `with` statement."""

    def __init__(self, wheels: Sequence[Path]) -> None:
        self.asked: list[str] = []
        pages: dict[str, list[str]] = {}
        files = {f"/files/{wheel.name}": wheel.read_bytes() for wheel in wheels}
        for wheel in wheels:
            link = f'<a href="/files/{wheel.name}">{wheel.name}</a>'
            pages.setdefault(f"/simple/{wheel.name.split('-')[0]}/", []).append(link)
        contents = {path: "".join(links).encode() for path, links in pages.items()} | files
        asked = self.asked

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                asked.append(self.path)
                content = contents.get(self.path)
                self.send_response(404 if content is None else 200)
                self.send_header("Content-Type", "text/html")
                self.end_headers()
                self.wfile.write(content or b"")

            def log_message(self, *_arguments: object) -> None:
                """Log nothing."""

        self._server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.address = f"http://127.0.0.1:{self._server.server_port}/simple/"
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def __enter__(self) -> PackageIndex:
        return self

    def __exit__(self, *_exception: object) -> None:
        self._server.shutdown()
        self._server.server_close()
