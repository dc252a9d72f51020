"""LoadScenario: another head and other tasks, loaded beside the running control loop."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.json_checks import is_identifier
from rastrainer.protocol import OPEN_PHASES
from rastrainer.scenario.library import ListedScenario, list_scenarios, user_library
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.loop.control_loop import TRIAL_IS_OPEN, ControlLoop
from rastrainer_simulator.state import Answer

BUSY = "A scenario is being loaded already: wait until it is loaded."
_HANDOVER_TIMEOUT_S = 5.0


class ScenarioLoader:
    """Makes simulations of other scenarios and has the control loop continue with them."""

    def __init__(
        self,
        control_loop: ControlLoop,
        make_simulation: Callable[[Path], Simulation],
        may_be_anywhere: bool,
        library: Path | None = None,
    ):
        """Prepare to load.

        Args:
            control_loop: continues with what is loaded.
            make_simulation: makes one of a scenario's folder; may take seconds.
            may_be_anywhere: any folder of this computer may be named, not only a scenario that
                comes with RASTrainer or is in the library.
            library: folder of the user's own scenarios; None is the usual one.
        """
        self._control_loop = control_loop
        self._make_simulation = make_simulation
        self._may_be_anywhere = may_be_anywhere
        self._library = library or user_library()
        self._pictures: dict[str, Path] = {}
        self._worker = ThreadPoolExecutor(max_workers=1, thread_name_prefix="scenario")
        self._loading: Future[Answer] | None = None

    def load(self, folder: str) -> Future[Answer]:
        """Load a scenario by its name, or by the path of its folder.

        Names are those of the scenarios that come with us and of those in the user's library.
        While one is being loaded, which is costly, no other is; in a trial none is.
        """
        if self._control_loop.latest.training.phase in OPEN_PHASES:
            return _refused(TRIAL_IS_OPEN)
        if self._loading is not None and not self._loading.done():
            return _refused(BUSY)
        self._loading = self._worker.submit(self._load, folder)
        return self._loading

    def reload(self) -> Future[Answer]:
        """Make the present scenario's simulation again, for instance with other settings."""
        return self._worker.submit(self._use, self._control_loop.setup.scenario.folder)

    def listed(self) -> Future[list[ListedScenario]]:
        """Return the scenarios that can be loaded by their names, and those with a problem."""
        return self._worker.submit(self._listed)

    def picture(self, name: str) -> Path | None:
        """Return the picture of a scenario that has been listed, None where it has none."""
        return self._pictures.get(name)

    def close(self) -> None:
        """Wait for the scenario that is being loaded, and load no other."""
        self._worker.shutdown(cancel_futures=True)

    def _load(self, folder: str) -> Answer:
        try:
            return self._use(self._found(folder), is_checked=True)
        except InputError as error:
            return Answer(0, False, str(error))

    def _use(self, folder: Path, is_checked: bool = False) -> Answer:
        try:
            simulation = self._make_simulation(folder)
            if is_checked and simulation.setup.scenario.procedures:
                # Here, since the import takes half a second that few need.
                from rastrainer_simulator.authoring.procedure_plan import require_usable_procedures

                require_usable_procedures(simulation.setup)
        except InputError as error:
            return Answer(0, False, str(error))
        handover = self._control_loop.replace_simulation(simulation)
        answer = handover.result(_HANDOVER_TIMEOUT_S)
        if not answer.ok:
            return answer
        scenario = simulation.setup.scenario
        return Answer(0, True, data={"name": scenario.name, "title": scenario.title})

    def _listed(self) -> list[ListedScenario]:
        found = list_scenarios([asset_path("scenarios"), self._library])
        self._pictures = {entry.name: entry.preview for entry in found if entry.preview}
        return found

    def _found(self, folder: str) -> Path:
        if is_identifier(folder):
            known = {entry.name: entry for entry in self._listed()}
            if folder in known:
                return known[folder].folder
        if not self._may_be_anywhere:
            names = ", ".join(entry.name for entry in self._listed() if not entry.problem)
            raise InputError(
                f"LoadScenario takes one of {names}; a simulator that listens beyond its own "
                "computer loads no other folder."
            )
        return Path(folder)


def _refused(sentence: str) -> Future[Answer]:
    refusal: Future[Answer] = Future()
    refusal.set_result(Answer(0, False, sentence))
    return refusal
