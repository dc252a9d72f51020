"""The scenarios at hand: those that come with RASTrainer and those in the user's folder."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.scenario import FILE_NAME, load_scenario

MOST_SCENARIOS = 200


@dataclass(frozen=True)
class ListedScenario:
    """One line of a list of scenarios.

    Attributes:
        name, title: of the scenario; the folder's name where it cannot be used.
        folder: where it is.
        preview: path of its picture; None where it has none.
        problem: a sentence that says why it cannot be used, empty where it can.
    """

    name: str
    title: str
    folder: Path
    preview: Path | None
    problem: str


def user_library() -> Path:
    """Return the folder of the user's own scenarios; it need not exist."""
    return Path.home() / "RASTrainer" / "scenarios"


def list_scenarios(folders: Iterable[Path]) -> list[ListedScenario]:
    """Return the scenarios in these folders, each below its own folder, by title.

    One that cannot be used is listed with its problem. Of two of the same name, which commands
    could not tell apart, the first folder's counts.
    """
    listed: dict[str, ListedScenario] = {}
    for library in folders:
        for path in sorted(Path(library).glob(f"*/{FILE_NAME}"))[:MOST_SCENARIOS]:
            entry = _listed(path.parent)
            listed.setdefault(entry.name, entry)
    return sorted(listed.values(), key=lambda entry: entry.title.casefold())


def _listed(folder: Path) -> ListedScenario:
    try:
        scenario = load_scenario(folder)
    except InputError as error:
        return ListedScenario(folder.name, folder.name, folder, None, str(error))
    return ListedScenario(scenario.name, scenario.title, folder, scenario.preview, "")
