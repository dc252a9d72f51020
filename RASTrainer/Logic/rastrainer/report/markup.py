"""Pieces of HTML; every text is escaped here and nowhere else."""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass

MOST_KEPT_TOGETHER = 10
"""Rows of a table; longer ones on one page would leave half of the page before empty."""


@dataclass(frozen=True)
class Cell:
    """A cell of a table: its text, how many columns it spans, and its color and class."""

    text: str
    span: int = 1
    color: str = ""
    kind: str = ""

    def html(self, tag: str, scope: str = "col") -> str:
        """Return the cell; `scope` is what it heads, where it is a `th`."""
        attributes = f' colspan="{self.span}"' if self.span > 1 else ""
        attributes += f' class="{self.kind}"' if self.kind else ""
        attributes += f' style="background:{self.color}"' if self.color else ""
        if tag == "th":
            if not self.text:
                # A corner heads nothing; a screen reader would name it.
                tag = "td"
            else:
                attributes += f' scope="{scope}{"group" if self.span > 1 else ""}"'
        return f"<{tag}{attributes}>{html.escape(self.text)}</{tag}>"


def table(
    headers: Sequence[Sequence[Cell | str]], rows: Sequence[Sequence[Cell | str]], kind: str = ""
) -> str:
    """Return a table of header lines and rows; the first cell of each row heads it.

    A table of more rows than `MOST_KEPT_TOGETHER` may go on on the next page when it is printed.
    """
    if len(rows) > MOST_KEPT_TOGETHER:
        kind = " ".join(filter(None, (kind, "long")))
    head = "".join(
        f"<tr>{''.join(_cell(cell).html('th') for cell in line)}</tr>" for line in headers
    )
    body = "".join(f"<tr>{_row(line)}</tr>" for line in rows)
    return f'<table class="{kind}"><thead>{head}</thead><tbody>{body}</tbody></table>'


def section(title: str, *parts: str) -> str:
    """Return a section with its headline."""
    return f"<section><h2>{html.escape(title)}</h2>{''.join(parts)}</section>"


def heading(text: str) -> str:
    """Return a headline within a section."""
    return f"<h3>{html.escape(text)}</h3>"


def paragraph(text: str, kind: str = "") -> str:
    """Return a paragraph."""
    attribute = f' class="{kind}"' if kind else ""
    return f"<p{attribute}>{html.escape(text)}</p>"


def bullets(texts: Sequence[str]) -> str:
    """Return a list."""
    return f"<ul>{''.join(f'<li>{html.escape(text)}</li>' for text in texts)}</ul>"


def figure(charts: Sequence[str], caption: str) -> str:
    """Return charts, which are HTML already, side by side as far as they fit."""
    inside = "".join(f'<div class="chart">{chart}</div>' for chart in charts)
    kind = "charts" if len(charts) > 1 else "chart-alone"
    return (
        f'<figure><div class="{kind}">{inside}</div>'
        f"<figcaption>{html.escape(caption)}</figcaption></figure>"
    )


def _row(line: Sequence[Cell | str]) -> str:
    first, *others = map(_cell, line)
    return first.html("th", "row") + "".join(cell.html("td") for cell in others)


def _cell(content: Cell | str) -> Cell:
    return content if isinstance(content, Cell) else Cell(content)
