"""Ralph, a learning record store, accepts the exported statements of trials and of drills."""

from __future__ import annotations

import base64
import json
import os
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import numpy as np
import pytest

from rastrainer.study.study_data import StudyData
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.export.xapi import statements
from Testing.drawn_drills import draw_drills
from Testing.free_port import free_port

# Ralph has its own environment, which `make soak` makes.
pytestmark = pytest.mark.soak

RALPH = Path(sys.prefix) / "ralph"
CREDENTIALS = "lab:secret"
TRAINEES = 4
# Ralph's store of files is made for one request: let it append. All else is Ralph's own.
SERVER = """
import sys
import uvicorn
from ralph.backends.data.base import BaseOperationType
from ralph.backends.data.fs import FSDataBackend
FSDataBackend.default_operation_type = BaseOperationType.APPEND
uvicorn.run("ralph.api:app", host="127.0.0.1", port=int(sys.argv[1]))
"""
WITHIN_S = 60.0


class Ralph:
    """The server, on its own port."""

    def __init__(self, folder: Path):
        self._folder = folder
        self._port = free_port()
        self.url = f"http://127.0.0.1:{self._port}/xAPI"
        agent = {"mbox": "mailto:lab@example.org"}
        scopes = ["statements/write", "statements/read"]
        entry = {"username": "lab", "hash": self._hash(), "scopes": scopes, "agent": agent}
        (folder / "auth.json").write_text(json.dumps([entry]))

    def _hash(self) -> str:
        code = "import bcrypt; print(bcrypt.hashpw(b'secret', bcrypt.gensalt(4)).decode())"
        return subprocess.check_output([RALPH / "bin" / "python", "-c", code], text=True).strip()

    def start(self) -> None:
        settings = {
            "RALPH_APP_DIR": str(self._folder),
            "RALPH_RUNSERVER_BACKEND": "fs",
            "RALPH_BACKENDS__LRS__FS__DEFAULT_DIRECTORY_PATH": str(self._folder / "statements"),
        }
        self._process = subprocess.Popen(
            [RALPH / "bin" / "python", "-c", SERVER, str(self._port)],
            env=os.environ | settings,
            cwd=self._folder,
        )
        deadline = time.monotonic() + WITHIN_S
        while True:
            try:
                socket.create_connection(("127.0.0.1", self._port)).close()
                return
            except OSError:
                assert time.monotonic() < deadline, "Ralph does not start"
                time.sleep(0.1)

    def kill(self) -> None:
        self._process.kill()
        self._process.wait()

    def post(self, found: list[dict]) -> int:
        """Send statements as any other program would; return the status."""
        token = base64.b64encode(CREDENTIALS.encode()).decode()
        request = urllib.request.Request(f"{self.url}/statements", json.dumps(found).encode())
        request.add_header("Authorization", f"Basic {token}")
        request.add_header("Content-Type", "application/json")
        request.add_header("X-Experience-API-Version", "1.0.3")
        with urllib.request.urlopen(request, timeout=WITHIN_S) as answer:
            return answer.status


@pytest.fixture(scope="module")
def study(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("cohort")
    command = [sys.executable, "-m", "rastrainer_simulator.cli.main", "simulate-cohort"]
    subprocess.check_call([*command, "--trainees", str(TRAINEES), "-o", str(folder / "study")])
    return folder / "study" / "study.db"


@pytest.fixture
def ralph(tmp_path):
    store = Ralph(tmp_path)
    store.start()
    yield store
    store.kill()


def test_ralph_answers_200_to_every_statement_and_204_to_repeats(ralph, study, tmp_path):
    words = ["export", str(study), "--format", "xapi", "-o", str(tmp_path / "out")]
    assert main([*words, "--home-page", "https://lab.example.org"]) == 0
    found = json.loads((tmp_path / "out" / "xapi" / "statements.json").read_text())
    assert len(found) >= 10 * TRAINEES
    drills = draw_drills(np.random.default_rng(3), TRAINEES)
    found += statements(StudyData("Drills", (), drills=drills), "https://lab.example.org")
    assert ralph.post(found) == 200
    for statement in found:
        assert ralph.post([statement]) == 204
