"""LoadScenario: another head and other tasks, loaded beside the running control loop."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.control_loop import ControlLoop
from rastrainer_simulator.simulation import Simulation
from rastrainer_simulator.state import Answer

_HANDOVER_TIMEOUT_S = 5.0


class ScenarioLoader:
    """Makes simulations of other scenarios and has the control loop go on with them."""

    def __init__(
        self,
        control_loop: ControlLoop,
        make_simulation: Callable[[Path], Simulation],
        may_be_anywhere: bool,
    ):
        """Prepare to load.

        Args:
            control_loop: goes on with what is loaded.
            make_simulation: makes one of a scenario's folder; may take seconds.
            may_be_anywhere: any folder of this computer may be named, not only one of the
                scenarios that come with RASTrainer.
        """
        self._control_loop = control_loop
        self._make_simulation = make_simulation
        self._may_be_anywhere = may_be_anywhere
        self._worker = ThreadPoolExecutor(max_workers=1, thread_name_prefix="scenario")

    def load(self, folder: str) -> Future[Answer]:
        """Load the scenario of a folder, by its path or by the name of one that comes with us."""
        return self._worker.submit(self._load, folder)

    def reload(self) -> Future[Answer]:
        """Make the present scenario's simulation anew, such as with other settings."""
        return self._worker.submit(self._use, self._control_loop.setup.scenario.folder)

    def close(self) -> None:
        """Wait for what is being loaded, and load nothing more."""
        self._worker.shutdown(cancel_futures=True)

    def _load(self, folder: str) -> Answer:
        try:
            return self._use(self._found(folder))
        except InputError as error:
            return Answer(0, False, str(error))

    def _use(self, folder: Path) -> Answer:
        try:
            simulation = self._make_simulation(folder)
        except InputError as error:
            return Answer(0, False, str(error))
        handover = self._control_loop.replace_simulation(simulation)
        answer = handover.result(_HANDOVER_TIMEOUT_S)
        if not answer.ok:
            return answer
        scenario = simulation.setup.scenario
        return Answer(0, True, data={"name": scenario.name, "title": scenario.title})

    def _found(self, folder: str) -> Path:
        shipped = {path.name: path for path in asset_path("scenarios").iterdir() if path.is_dir()}
        if folder in shipped:
            return shipped[folder]
        if not self._may_be_anywhere:
            names = ", ".join(sorted(shipped))
            raise InputError(
                f"LoadScenario takes one of {names}; a simulator that listens beyond its own "
                "computer loads no other folder."
            )
        return Path(folder)
