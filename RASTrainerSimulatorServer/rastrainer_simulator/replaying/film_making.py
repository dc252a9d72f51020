"""Have a film made beside the running control loop, and follow how far it is."""

from __future__ import annotations

import json
import pickle
import subprocess
import threading
from concurrent.futures import Future
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.private_folder import python_words
from rastrainer_simulator.child_process import BELOW_NORMAL, environment_without_secrets
from rastrainer_simulator.replaying.film import Film

MODULE = "rastrainer_simulator.replaying.film_process"


class FilmMaking:
    """A film that a process of its own makes.

    Attributes:
        share: of the work done, 0 to 1.
        film: comes when it is made; an `InputError` says in one sentence why there is none.
    """

    def __init__(self, journal: Path, scenario: Path, robot_meshes: Path | None) -> None:
        """Begin.

        Args:
            journal: of the trial; it is only read.
            scenario: folder of the scenario that the trial was played with.
            robot_meshes: folder of the robot's official meshes; None is our own.
        """
        self.share = 0.0
        self.film: Future[Film] = Future()
        wanted = {
            "journal": str(journal),
            "scenario": str(scenario),
            "robotMeshes": None if robot_meshes is None else str(robot_meshes),
        }
        self._process: subprocess.Popen[bytes] | None = None
        try:
            self._process = _start()
        except OSError as error:
            self.film.set_exception(InputError(f"The trial cannot be shown again: {error}."))
            return
        follow = threading.Thread(target=self._follow, args=(wanted,), name="film", daemon=True)
        follow.start()

    def cancel(self) -> None:
        """End the making, where it still goes on."""
        if self._process is not None:
            self._process.kill()

    def _follow(self, wanted: dict[str, str | None]) -> None:
        with self._process as process:
            try:
                process.stdin.write(json.dumps(wanted).encode())
                process.stdin.close()
                film = self._read(process)
            except (OSError, EOFError, pickle.UnpicklingError):
                said = process.stderr.read().decode(errors="replace").strip().splitlines()
                sentence = said[-1] if said else f"status {process.wait()}"
                self.film.set_exception(InputError(f"The trial cannot be shown again: {sentence}"))
            else:
                self.film.set_result(film)

    def _read(self, process: subprocess.Popen[bytes]) -> Film:
        while True:
            news = pickle.load(process.stdout)
            if isinstance(news, Film):
                return news
            self.share = news


def _start() -> subprocess.Popen[bytes]:
    pipe = subprocess.PIPE
    return subprocess.Popen(
        python_words(MODULE),
        stdin=pipe,
        stdout=pipe,
        stderr=pipe,
        env=environment_without_secrets(),
        creationflags=BELOW_NORMAL,
    )
