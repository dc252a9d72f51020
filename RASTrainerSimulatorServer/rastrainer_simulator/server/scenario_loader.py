"""LoadScenario: loads another head and other tasks while the control loop runs."""

from __future__ import annotations

import logging
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.json_checks import is_identifier
from rastrainer.scenario.library import ListedScenario, list_scenarios, user_library
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.loop.control_loop import BEING_SET_UP, ControlLoop
from rastrainer_simulator.state import Answer, answered
from rastrainer_simulator.texts.texts import say

FAILED = say("scenario failed")

_log = logging.getLogger(__name__)


class ScenarioLoader:
    """Makes simulations of other scenarios and has the control loop continue with them.

    One at a time, since that is costly, and between two trials: from the request until the
    simulation is used, or has failed, no trial begins. All methods belong to one thread.
    """

    def __init__(
        self,
        control_loop: ControlLoop,
        make_simulation: Callable[[Path], Simulation],
        may_be_anywhere: bool,
        library: Path | None = None,
    ):
        """Prepare to load, from any folder of this computer if it `may_be_anywhere`."""
        self._control_loop = control_loop
        self._make_simulation = make_simulation
        self._may_be_anywhere = may_be_anywhere
        self._library = library or user_library()
        self.pictures: dict[str, Path] = {}
        """Pictures of the listed scenarios, by name."""
        self._worker = ThreadPoolExecutor(max_workers=1, thread_name_prefix="scenario")
        self._loading: Future[Answer] | None = None

    def load(self, folder: str) -> Future[Answer]:
        """Load a scenario by its name (ours, or in the user's library), or by its folder's path.

        It is refused in a trial, and while another simulation is being made.
        """
        return self._begin(lambda: self._found(folder), is_checked=True)

    def reload(self) -> Future[Answer]:
        """Make the present scenario's simulation again, for instance with other settings."""
        return self._begin(lambda: self._control_loop.setup.scenario.folder)

    def find(self, name: str) -> Scenario:
        """Return a scenario by its name, the present one for ""; from any thread."""
        present = self._control_loop.setup.scenario
        if name in ("", present.name):
            return present
        known = self._known()
        if name in known:
            return load_scenario(known[name].folder)
        raise InputError(f"There is no scenario {name} here, in which the trial was played.")

    def listed(self) -> Future[list[ListedScenario]]:
        """Return the scenarios that can be loaded by their names, and those with a problem."""
        return self._worker.submit(lambda: list(self._known().values()))

    def close(self) -> None:
        """Wait for the scenario that is being loaded, and load no other."""
        self._worker.shutdown(cancel_futures=True)

    def _begin(self, find: Callable[[], Path], is_checked: bool = False) -> Future[Answer]:
        if self._loading is not None and not self._loading.done():
            return answered(Answer(0, False, BEING_SET_UP))
        # Here, not in the worker: no trial that is asked for from now on may come before.
        begun = self._control_loop.begin_replacement()
        self._loading = self._worker.submit(self._replace, begun, find, is_checked)
        return self._loading

    def _replace(self, begun: Future[Answer], find: Callable[[], Path], is_checked: bool) -> Answer:
        if not begun.result().ok:
            return begun.result()
        try:
            simulation = self._make_simulation(find())
            scenario = simulation.setup.scenario
            if is_checked and scenario.procedures:
                # Here, since the import takes half a second that few need.
                from rastrainer_simulator.authoring.procedure_plan import require_usable_procedures

                require_usable_procedures(simulation.setup)
            answer = self._control_loop.replace_simulation(simulation).result()
            if not answer.ok:
                return answer
            return Answer(0, True, data={"name": scenario.name, "title": scenario.title})
        except InputError as error:
            return Answer(0, False, str(error))
        except Exception:
            _log.exception("A scenario could not be loaded")
            return Answer(0, False, FAILED)
        finally:
            self._control_loop.end_replacement()

    def _known(self) -> dict[str, ListedScenario]:
        found = list_scenarios([asset_path("scenarios"), self._library])
        self.pictures = {entry.name: entry.preview for entry in found if entry.preview}
        return {entry.name: entry for entry in found}

    def _found(self, folder: str) -> Path:
        if self._may_be_anywhere and not is_identifier(folder):
            return Path(folder)
        known = self._known()
        if folder in known:
            return known[folder].folder
        if self._may_be_anywhere:
            return Path(folder)
        names = ", ".join(name for name, entry in known.items() if not entry.problem)
        raise InputError(
            f"The scenarios here are {names}; a simulator that listens beyond its own computer "
            "loads no other folder."
        )
