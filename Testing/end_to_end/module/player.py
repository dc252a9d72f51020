"""A trainee who plays the trial that the instructor has started, over a separate link."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.errors import RASTrainerError
from rastrainer.igtl.client import Client
from rastrainer.journal.journal_file import read_journal
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.virtual.scripted_trial import send, send_hello
from Testing.end_to_end.onto_skin import carry_to, lower_onto_skin

ABOVE_MM = 40.0


class Player:
    """Touches the fiducials of a running trial in a separate thread.

    The journal tells where the head stands, which a person sees on the screen.
    """

    def __init__(self, port: int, records: Path) -> None:
        self._port = port
        self._records = records
        self._error: Exception | None = None
        self._thread: threading.Thread | None = None

    def touch(self, first: int, last: int) -> None:
        """Start touching the points numbered `first` to `last`."""
        self._begin(lambda client: self._touch(client, first, last))

    def lower(self, number: int) -> None:
        """Start lowering the tip onto the point with a number."""
        self._begin(lambda client: self._lower(client, number))

    def capture(self) -> None:
        """Start touching the skin where the tip is."""
        self._begin(lambda client: send(client, "Capture", {}))

    def register(self) -> None:
        """Start registering the touched points."""
        self._begin(lambda client: send(client, "Register", {}))

    @property
    def is_done(self) -> bool:
        """Whether the started work is over; its errors are raised here."""
        if self._error is not None:
            raise self._error
        return self._thread is None or not self._thread.is_alive()

    def _begin(self, play) -> None:
        def run() -> None:
            try:
                with Client(port=self._port) as client:
                    send_hello(client, "player")
                    play(client)
            except (RASTrainerError, AssertionError) as error:
                self._error = error

        self._thread = threading.Thread(target=run, daemon=True)
        self._thread.start()

    def _touch(self, client: Client, first: int, last: int) -> None:
        for number in range(first, last + 1):
            above = self._lower(client, number)
            send(client, "Capture", {})
            carry_to(client, above)

    def _lower(self, client: Client, number: int) -> np.ndarray:
        """Lower the tip onto a point; return the place above it."""
        state = json.loads(client.wait_for("SimState", timeout=60).content.text)
        above, fiducial, center = list(self._places(state["trialId"]))[number - 1]
        carry_to(client, above)
        lower_onto_skin(client, fiducial, center)
        return above

    def _places(self, trial_id: str) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        (journal,) = self._records.glob(f"*_{trial_id}.journal")
        header = read_journal(journal).header
        scenario = load_scenario(asset_path("scenarios", "colin27"))
        head_to_world = scenario.perturbed_head_to_world(header.seed)
        fiducials = scenario.task(header.task).fiducials
        center = transforms.apply(head_to_world, scenario.target.position_ras)
        for fiducial in transforms.apply(head_to_world, fiducials):
            outward = (fiducial - center) / np.linalg.norm(fiducial - center)
            yield fiducial + ABOVE_MM * outward, fiducial, center
