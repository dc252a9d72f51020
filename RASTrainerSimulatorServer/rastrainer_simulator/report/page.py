"""The templates of a report, and the functions with which they write numbers and names."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from rastrainer.number_text import counted, fixed, p_phrase, p_text, percent, signed
from rastrainer.study.outcomes import mode_name, mode_title, short_mode_title, task_title
from rastrainer.study.tre_calibration import share_text
from rastrainer_simulator.statistics.intervals import ALPHA, TARGET_POWER, Estimate


@dataclass(frozen=True)
class Cell:
    """A cell of a table; `kind` is its class."""

    text: str
    span: int = 1
    color: str = ""
    kind: str = ""


def cell(content: Any, span: int = 1, color: str = "", kind: str = "") -> Cell:
    return content if isinstance(content, Cell) else Cell(str(content), span, color, kind)


def left(words: str) -> Cell:
    return Cell(words, kind="text")


def interval_text(found: Estimate, digits: int, unit: str = "") -> str:
    low, high = (fixed(limit, digits) for limit in found.interval)
    return f"{fixed(found.value, digits)}{unit} [{low}, {high}]"


def or_dash(value: float | None, digits: int) -> str:
    return "–" if value is None else fixed(value, digits)


def p_or_dash(p: float | None) -> str:
    return "–" if p is None else p_text(p)


WRITERS = (
    *(cell, left, interval_text, or_dash, p_or_dash, share_text),
    *(counted, fixed, p_phrase, p_text, percent, signed),
    *(mode_name, mode_title, short_mode_title, task_title),
)
"""The functions that templates call."""


_TEMPLATES = Environment(
    loader=FileSystemLoader(Path(__file__).with_name("templates")),
    autoescape=True,
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)
for _writer in WRITERS:
    _TEMPLATES.globals[_writer.__name__] = _TEMPLATES.filters[_writer.__name__] = _writer
_TEMPLATES.globals |= {"alpha": ALPHA, "target_power": TARGET_POWER}
_MACROS = vars(_TEMPLATES.get_template("elements.html").module)
_TEMPLATES.globals |= {name: each for name, each in _MACROS.items() if not name.startswith("_")}


def render(template: str, **values: Any) -> Markup:
    """Return a template with values, which are escaped unless they are HTML already."""
    return Markup(_TEMPLATES.get_template(f"{template}.html").render(values))
