"""A package index on the loopback that offers wheels and notes what it was asked for."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path


class PackageIndex:
    """Serves wheels as an index does; to be used in a `with` statement.

    Attributes:
        address: of the index.
        asked: paths that it was asked for.
    """

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
                """Say nothing."""

        self._server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.address = f"http://127.0.0.1:{self._server.server_port}/simple/"
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def __enter__(self) -> PackageIndex:
        return self

    def __exit__(self, *_exception: object) -> None:
        self._server.shutdown()
        self._server.server_close()
