"""What the sections of a report are made of: HTML with escaped text."""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass

from rastrainer.number_text import with_units

MAX_KEPT_TOGETHER = 10
"""Rows; keeping longer tables on one page could leave half a page empty."""


@dataclass(frozen=True)
class Cell:
    """A cell of a table; `kind` is its class."""

    text: str
    span: int = 1
    color: str = ""
    kind: str = ""

    def html(self, scope: str = "") -> str:
        """Return the cell, as the header of a `scope` where one is given."""
        # A corner is no header; a screen reader would read it.
        tag = "th" if scope and self.text else "td"
        attributes = f' colspan="{self.span}"' if self.span > 1 else ""
        attributes += f' class="{self.kind}"' if self.kind else ""
        attributes += f' style="background:{self.color}"' if self.color else ""
        if tag == "th":
            attributes += f' scope="{scope}{"group" if self.span > 1 else ""}"'
        return f"<{tag}{attributes}>{_flowing(self.text)}</{tag}>"


def text(words: str) -> Cell:
    """Return a cell that is aligned to the left, and may take several lines."""
    return Cell(words, kind="text")


Line = list[Cell | str]
"""A row of a table."""


def table(
    headers: Sequence[Sequence[Cell | str]], rows: Sequence[Sequence[Cell | str]], kind: str = ""
) -> str:
    """Return a table; the first cell of each row is its header.

    Tables of more than `MAX_KEPT_TOGETHER` rows may break across printed pages.
    """
    if len(rows) > MAX_KEPT_TOGETHER:
        kind = " ".join(filter(None, (kind, "long")))
    head = "".join(_row([_cell(cell).html("col") for cell in line]) for line in headers)
    body = "".join(
        _row([_cell(line[0]).html("row"), *(_cell(cell).html() for cell in line[1:])])
        for line in rows
    )
    return f'<table class="{kind}"><thead>{head}</thead><tbody>{body}</tbody></table>'


def section(title: str, *parts: str) -> str:
    return f"<section><h2>{html.escape(title)}</h2>{''.join(parts)}</section>"


def heading(words: str) -> str:
    """Return a heading within a section."""
    return f"<h3>{html.escape(words)}</h3>"


def paragraph(words: str, kind: str = "") -> str:
    attribute = f' class="{kind}"' if kind else ""
    return f"<p{attribute}>{_flowing(words)}</p>"


def bullets(texts: Sequence[str]) -> str:
    return f"<ul>{''.join(f'<li>{_flowing(each)}</li>' for each in texts)}</ul>" if texts else ""


def figure(charts: Sequence[str], caption: str) -> str:
    """Return charts, which are HTML already, side by side if they fit."""
    inside = "".join(f'<div class="chart">{chart}</div>' for chart in charts)
    kind = "charts" if len(charts) > 1 else "chart-alone"
    return (
        f'<figure><div class="{kind}">{inside}</div>'
        f"<figcaption>{_flowing(caption)}</figcaption></figure>"
    )


def _flowing(words: str) -> str:
    return html.escape(with_units(words))


def _row(cells: Sequence[str]) -> str:
    return f"<tr>{''.join(cells)}</tr>"


def _cell(content: Cell | str) -> Cell:
    return content if isinstance(content, Cell) else Cell(content)
