"""A learning record store for tests, as strict as Ralph 5.1 was found to be, over real sockets."""

from __future__ import annotations

import base64
import json
import threading
import uuid
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

CREDENTIALS = "lab:secret"


class RecordStoreDouble(ThreadingHTTPServer):
    """Keeps statements; a statement is never changed, and all of a request are taken or none.

    Attributes:
        statements: by their UUIDs.
        requests: how many statements each request had.
        planned: statuses with which the next requests are answered, instead of being processed.
        refused: UUIDs of statements that are answered with 400.
        crashes: how many of the next requests are stored, but get no answer.
    """

    def __init__(self, port: int = 0) -> None:
        super().__init__(("127.0.0.1", port), _Handler)
        self.statements: dict[str, dict] = {}
        self.requests: list[int] = []
        self.planned: list[int] = []
        self.refused: set[str] = set()
        self.crashes = 0
        threading.Thread(target=self.serve_forever, kwargs={"poll_interval": 0.01}).start()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_address[1]}/xAPI"

    def __exit__(self, *_exception: object) -> None:
        self.shutdown()
        self.server_close()

    def take(self, statements: list[dict]) -> int:
        """Return the status of a request."""
        for statement in statements:
            assert str(uuid.UUID(statement["id"])) == statement["id"]
            assert statement["actor"]["account"]["homePage"].startswith("https://")
        if any(each["id"] in self.refused for each in statements):
            return 400
        known = [each for each in statements if each["id"] in self.statements]
        if any(self.statements[each["id"]] != each for each in known):
            return 409
        self.statements |= {each["id"]: each for each in statements}
        return 204 if len(known) == len(statements) else 200


class _Handler(BaseHTTPRequestHandler):
    server: RecordStoreDouble

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"]))
        token = base64.b64encode(CREDENTIALS.encode()).decode()
        if self.headers["Authorization"] != f"Basic {token}":
            return self._answer(401)
        if self.path != "/xAPI/statements":
            return self._answer(404)
        assert self.headers["X-Experience-API-Version"] == "1.0.3"
        assert self.headers["Content-Type"] == "application/json"
        if self.server.planned:
            return self._answer(self.server.planned.pop(0))
        statements = json.loads(body)
        self.server.requests.append(len(statements))
        status = self.server.take(statements)
        if self.server.crashes:
            self.server.crashes -= 1
            return self.connection.close()
        return self._answer(status)

    def log_message(self, *_arguments: object) -> None:
        pass

    def _answer(self, status: int) -> None:
        self.send_response(status)
        self.send_header("Location", "http://127.0.0.1:1/elsewhere")
        self.send_header("Content-Length", "0" if status == 204 else "2")
        self.end_headers()
        if status != 204:
            self.wfile.write(b"[]")
