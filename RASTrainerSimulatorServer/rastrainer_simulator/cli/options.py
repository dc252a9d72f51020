"""Commands, and functions that several of them share."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from rastrainer_simulator.cli.arg import Argument, add_all

if TYPE_CHECKING:
    from rastrainer.study.study_data import StudyData


@dataclass(frozen=True)
class Subcommand:
    """A command of `rastrainer`, or an action of one; `run` returns the exit status."""

    name: str
    help: str
    run: Callable[[argparse.Namespace], int] | None = None
    arguments: Sequence[Argument] = ()
    description: str | None = None
    actions: Sequence[Subcommand] = ()

    def add_to(self, subparsers: argparse._SubParsersAction) -> None:
        parser = subparsers.add_parser(self.name, help=self.help, description=self.description)
        add_all(parser, self.arguments)
        parser.set_defaults(run=self.run)
        if self.actions:
            of_actions = parser.add_subparsers(title="what to do", required=True, metavar="ACTION")
            for action in self.actions:
                action.add_to(of_actions)


def read_known_study(arguments: argparse.Namespace) -> StudyData:
    """Return the study of a command's arguments `study` and `incomplete`."""
    # Only here: most commands read no study, and need not wait for its import.
    from rastrainer.study.database.cohort_store import IncompleteStudyError
    from rastrainer.study.study_data import read_study_data

    try:
        return read_study_data(arguments.study, arguments.incomplete)
    except IncompleteStudyError as error:
        raise IncompleteStudyError(f"{error} --incomplete takes it as it is.") from None


def announce(program: str, what: str) -> None:
    """Print at once what one of our programs does, such as "board" and "is on http://…"."""
    print(f"RASTrainer {program} {what}", flush=True)


def json_text(value: Any) -> str:
    """Return a value as JSON, arrays and dataclasses, too; `ValueError` for an infinite number."""
    return json.dumps(
        value,
        allow_nan=False,
        indent=1,
        default=lambda one: one.tolist() if hasattr(one, "tolist") else asdict(one),
    )


def picked(value: object, *names: str) -> dict[str, Any]:
    return {name: getattr(value, name) for name in names}


def aligned(lines: Sequence[Sequence[str]], left: int) -> list[str]:
    """Return rows of cells as lines; `left` columns are aligned to the left, the others right."""
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if place < left else cell.rjust(width)
            for place, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table with a line below its header; the first column is aligned to the left."""
    head, *others = aligned([header, *rows], 1)
    width = max(map(len, (head, *others)))
    return "\n".join([head, "-" * width, *others])
