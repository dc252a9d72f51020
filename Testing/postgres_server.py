"""The tests' own PostgreSQL server: made in a folder, and killed and removed at the end."""

from __future__ import annotations

import contextlib
import itertools
import os
import pwd
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

import trustme

from rastrainer.errors import InputError
from rastrainer.study.database.database import LockWait, PostgresAddress, study_place
from rastrainer.study.database.study import Study
from Testing.free_port import free_port

PROGRAMS = sorted(Path("/usr/lib/postgresql").glob("*/bin"), key=lambda path: float(path.parts[-2]))
"""Debian's, by version."""
USER = "nobody"
"""User of the server if the tests run as root, which PostgreSQL refuses."""
TIMEOUT_S = 60.0


class PostgresServer:
    """A server for this computer alone; ended by the `with` statement.

    Attributes:
        port: on which it listens.
        socket_folder: of its socket.
    """

    def __init__(self) -> None:
        assert PROGRAMS, "Debian's package postgresql is missing; `make soak` installs it"
        self.programs = PROGRAMS[-1]
        self._folder = Path(tempfile.mkdtemp(prefix="rastrainer-postgres-"))
        self._folder.chmod(0o755)
        self.socket_folder, self._data = self._folder / "socket", self._folder / "data"
        for folder in (self.socket_folder, self._data):
            folder.mkdir(mode=0o700)
            if os.geteuid() == 0:
                os.chown(folder, pwd.getpwnam(USER).pw_uid, pwd.getpwnam(USER).pw_gid)
        self.socket_folder.chmod(0o755)
        self.port = free_port()
        self._numbers = itertools.count()
        words = ("-A", "trust", "-E", "UTF8", "--locale=C", "-U", "tester", "--no-sync")
        command = self._as_user(str(self.programs / "initdb"), "-D", str(self._data), *words)
        subprocess.run(command, check=True, capture_output=True, cwd="/")
        self._process: subprocess.Popen | None = None
        self.start()

    def __enter__(self) -> PostgresServer:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.kill()
        shutil.rmtree(self._folder)

    def start(self) -> None:
        """Start it, and wait until it answers, also after a crash."""
        settings = {
            "listen_addresses": "127.0.0.1,127.0.0.2",
            "unix_socket_directories": str(self.socket_folder),
            "unix_socket_permissions": "0777",
            "port": str(self.port),
        }
        words = [word for name, value in settings.items() for word in ("-c", f"{name}={value}")]
        command = self._as_user(str(self.programs / "postgres"), "-D", str(self._data), *words)
        with (self._folder / "log").open("ab") as log:
            self._process = subprocess.Popen(
                command, stdout=log, stderr=log, cwd="/", start_new_session=True
            )
        give_up = time.monotonic() + TIMEOUT_S
        ready = [str(self.programs / "pg_isready"), "-q", "-h", "127.0.0.1", "-p", str(self.port)]
        while subprocess.run(ready, check=False).returncode != 0:
            assert time.monotonic() < give_up, (self._folder / "log").read_text()[-2000:]
            assert self._process.poll() is None, (self._folder / "log").read_text()[-2000:]
            time.sleep(0.05)

    def kill(self) -> None:
        """End all of its processes at once, as a crash would."""
        if self._process is None:
            return
        children = _children_of(self._process.pid)
        for pid in (self._process.pid, *children):
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        self._process.wait()
        self._process = None
        give_up = time.monotonic() + TIMEOUT_S
        # A new one starts only when the shared memory of the old one is released.
        while any(Path(f"/proc/{pid}").exists() and _is_alive(pid) for pid in children):
            assert time.monotonic() < give_up
            time.sleep(0.01)

    def new_study(self) -> PostgresAddress:
        """Create an empty database and return its address."""
        name = f"study_{next(self._numbers)}"
        self.execute(f"CREATE DATABASE {name} TEMPLATE template0 ENCODING 'UTF8'")
        return self.address(name)

    def address(self, database: str, user: str = "tester") -> PostgresAddress:
        """Return the address of a database."""
        return study_place(f"postgresql://{user}@127.0.0.1:{self.port}/{database}")

    def execute(self, sql: str, database: str = "postgres") -> str:
        """Have `psql` execute SQL as the administrator; return its output."""
        words = ("-h", "127.0.0.1", "-p", str(self.port), "-U", "tester", "-d", database)
        command = [str(self.programs / "psql"), *words, "-qAtX", "-v", "ON_ERROR_STOP=1", "-c", sql]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()

    def ask_for_passwords(self) -> None:
        """Require a password from now on, except of the administrator through the socket."""
        rules = "local all tester trust\nhost all tester 127.0.0.1/32 trust\n"
        (self._data / "pg_hba.conf").write_text(f"{rules}host all all 0.0.0.0/0 scram-sha-256\n")
        self.execute("SELECT pg_reload_conf()")

    def offer_tls(self, folder: Path, name: str) -> Path:
        """Offer TLS with a new certificate for an IP address; return its issuer's certificate."""
        issuer = trustme.CA()
        key = self._data / "server.key"
        issued = issuer.issue_cert(name)
        (self._data / "server.crt").write_bytes(issued.cert_chain_pems[0].bytes())
        key.write_bytes(issued.private_key_pem.bytes())
        key.chmod(0o600)
        if os.geteuid() == 0:
            os.chown(key, pwd.getpwnam(USER).pw_uid, pwd.getpwnam(USER).pw_gid)
        self.execute("ALTER SYSTEM SET ssl = on")
        self.kill()
        self.start()
        trusted = folder / f"issuer-of-{name}.pem"
        issuer.cert_pem.write_to_path(str(trusted))
        return trusted

    def _as_user(self, *command: str) -> list[str]:
        if os.geteuid() != 0:
            return list(command)
        return ["setpriv", f"--reuid={USER}", "--regid=nogroup", "--clear-groups", *command]


def _children_of(pid: int) -> list[int]:
    return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def _is_alive(pid: int) -> bool:
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    return False


def opened_when_available(place: object, lock_wait: LockWait | None = None) -> Study:
    """Return a study, opened once its server answers."""
    give_up = time.monotonic() + TIMEOUT_S
    while True:
        try:
            return Study.open(place, lock_wait)
        except InputError:
            assert time.monotonic() < give_up
            time.sleep(0.05)
