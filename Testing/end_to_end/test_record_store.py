"""Statements of a whole virtual study reach Ralph, a learning record store, through its crashes."""

from __future__ import annotations

import base64
import json
import os
import socket
import subprocess
import sys
import time
import urllib.request
import uuid
from pathlib import Path

import pytest

from rastrainer.study.database.study import Study
from rastrainer.study.study_data import read_study_data
from rastrainer_simulator.cli.send_statements import Sender, SentStatements
from rastrainer_simulator.export.xapi import statements
from rastrainer_simulator.net.record_store import (
    RECORD_STORE_FILE,
    RecordStore,
    StoreUnreachableError,
)
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.free_port import free_port

# Ralph has its own environment, which `make soak` makes.
pytestmark = pytest.mark.soak

RALPH = Path(sys.prefix) / "ralph"
CREDENTIALS, HOME = "lab:secret", "https://lab.example.org"
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
    """The server, on its own port; what it has accepted stays when it is killed."""

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
        return self._ask("", json.dumps(found).encode())[0]

    def kept(self) -> list[dict]:
        """Return all statements that it has."""
        found, query = [], "?limit=100"
        while query:
            _, answer = self._ask(query)
            page = json.loads(answer)
            found += page["statements"]
            more = page.get("more", "")
            query = f"?{more.partition('?')[2]}" if more else ""
        return found

    def _ask(self, query: str, body: bytes | None = None) -> tuple[int, bytes]:
        token = base64.b64encode(CREDENTIALS.encode()).decode()
        request = urllib.request.Request(f"{self.url}/statements{query}", body)
        request.add_header("Authorization", f"Basic {token}")
        request.add_header("Content-Type", "application/json")
        request.add_header("X-Experience-API-Version", "1.0.3")
        with urllib.request.urlopen(request, timeout=WITHIN_S) as answer:
            return answer.status, answer.read()


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


def test_a_repeatedly_killed_store_has_each_statement_once(ralph, study, tmp_path):
    expected = statements(read_study_data(study), HOME)
    assert len(expected) >= 10 * TRAINEES
    sent = SentStatements(tmp_path / "study.db", ralph.url, HOME)
    for count in range(5, len(expected), 9):
        Sender(lambda c=count: expected[:c], RecordStore(ralph.url, CREDENTIALS), sent).send()
        ralph.kill()
        away = Sender(lambda: expected, RecordStore(ralph.url, CREDENTIALS), sent)
        with pytest.raises(StoreUnreachableError):
            away.send()
        ralph.start()
    Sender(lambda: expected, RecordStore(ralph.url, CREDENTIALS), sent).send()
    kept = {each["id"]: each for each in ralph.kept()}
    assert sorted(each["id"] for each in ralph.kept()) == sorted(each["id"] for each in expected)
    for statement in expected:
        assert kept[statement["id"]].items() >= statement.items()


def test_ralph_answers_200_to_every_statement_and_204_to_repeats(ralph, study):
    for statement in statements(read_study_data(study), HOME):
        assert ralph.post([statement]) == 200
        assert ralph.post([statement]) == 204


def test_trials_are_pushed_as_they_are_stored_and_wait_while_ralph_is_down(ralph, tmp_path):
    path = tmp_path / "small.db"
    with Study.open(path) as study:
        study.create_trainee("T001", consent=True)
        study.add_trial(make_record(trainee="T001"), score=gentle_score(110.0, 0.5))
    (tmp_path / "secret").write_text(CREDENTIALS)
    (tmp_path / "secret").chmod(0o600)
    settings = {"store": ralph.url, "homePage": HOME, "credentials": "secret"}
    (tmp_path / RECORD_STORE_FILE).write_text(json.dumps(settings))
    words = ["send-statements", str(path), "--watch", "1", "--config", str(tmp_path)]
    command = [sys.executable, "-m", "rastrainer_simulator.cli.main", *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as sending:
        assert "stored" in sending.stdout.readline()
        ralph.kill()
        with Study.open(path) as study:
            later = make_record(trainee="T001", trialId=str(uuid.uuid4()))
            study.add_trial(later, score=gentle_score(90.0, 0.5))
        assert "Nothing is lost" in sending.stdout.readline()
        ralph.start()
        while "stored" not in sending.stdout.readline():
            pass
        sending.terminate()
    expected = {each["id"] for each in statements(read_study_data(path), HOME)}
    kept = [each["id"] for each in ralph.kept()]
    assert sorted(kept) == sorted(expected)
