"""The HTML elements of a report, with escaped text, and the page around them."""

from __future__ import annotations

import html
import re
from collections.abc import Sequence
from dataclasses import dataclass

MAX_KEPT_TOGETHER = 10
"""Rows; keeping longer tables on one page could leave half a page empty."""


@dataclass(frozen=True)
class Cell:
    """A table cell: text, column span, color and class."""

    text: str
    span: int = 1
    color: str = ""
    kind: str = ""

    def html(self, tag: str, scope: str = "col") -> str:
        """Return the cell; `scope` is that of a `th`."""
        attributes = f' colspan="{self.span}"' if self.span > 1 else ""
        attributes += f' class="{self.kind}"' if self.kind else ""
        attributes += f' style="background:{self.color}"' if self.color else ""
        if tag == "th":
            if not self.text:
                # A corner is no header; a screen reader would read it.
                tag = "td"
            else:
                attributes += f' scope="{scope}{"group" if self.span > 1 else ""}"'
        return f"<{tag}{attributes}>{html.escape(self.text)}</{tag}>"


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
    head = "".join(
        f"<tr>{''.join(_cell(cell).html('th') for cell in line)}</tr>" for line in headers
    )
    body = "".join(f"<tr>{_row(line)}</tr>" for line in rows)
    return f'<table class="{kind}"><thead>{head}</thead><tbody>{body}</tbody></table>'


def section(title: str, *parts: str) -> str:
    """Return a section with its heading."""
    return f"<section><h2>{html.escape(title)}</h2>{''.join(parts)}</section>"


def heading(text: str) -> str:
    """Return a heading within a section."""
    return f"<h3>{html.escape(text)}</h3>"


def paragraph(text: str, kind: str = "") -> str:
    """Return a paragraph."""
    attribute = f' class="{kind}"' if kind else ""
    return f"<p{attribute}>{_flowing(text)}</p>"


def bullets(texts: Sequence[str]) -> str:
    """Return a list."""
    return f"<ul>{''.join(f'<li>{_flowing(text)}</li>' for text in texts)}</ul>"


def figure(charts: Sequence[str], caption: str) -> str:
    """Return charts, which are HTML already, side by side if they fit."""
    inside = "".join(f'<div class="chart">{chart}</div>' for chart in charts)
    kind = "charts" if len(charts) > 1 else "chart-alone"
    return (
        f'<figure><div class="{kind}">{inside}</div>'
        f"<figcaption>{_flowing(caption)}</figcaption></figure>"
    )


_BEFORE_UNIT = re.compile(r"(?<=\d) (?=(?:%|(?:mm|s|of 100)\b))")


def _flowing(text: str) -> str:
    """Return escaped text in which no line ends between a number and its unit."""
    return html.escape(_BEFORE_UNIT.sub("\N{NO-BREAK SPACE}", text))


def _row(line: Sequence[Cell | str]) -> str:
    first, *others = map(_cell, line)
    return first.html("th", "row") + "".join(cell.html("td") for cell in others)


def _cell(content: Cell | str) -> Cell:
    return content if isinstance(content, Cell) else Cell(content)


STYLE = """
@page { size: A4; margin: 16mm 15mm 18mm; }
* { box-sizing: border-box; }
html { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
body { margin: 0 auto; max-width: 190mm; padding: 10mm 8mm; color: #1f2933; background: #fff;
  font: 10.5pt/1.5 'Helvetica Neue', Helvetica, Arial, 'Liberation Sans', sans-serif; }
header { border-bottom: 3px solid #1f2933; margin-bottom: 7mm; padding-bottom: 3mm; }
header .kind { color: #6b7785; font-size: 9pt; letter-spacing: .08em; text-transform: uppercase; }
h1 { font-size: 20pt; line-height: 1.2; margin: 1mm 0 2mm; }
h2 { font-size: 13.5pt; margin: 9mm 0 2.5mm; padding-top: 2mm; border-top: 1px solid #cbd2d9;
  break-after: avoid; }
h3 { font-size: 10.5pt; margin: 5mm 0 1.5mm; break-after: avoid; }
p { margin: 0 0 2.5mm; orphans: 3; widows: 3; }
p:has(+ table) { break-after: avoid; break-inside: avoid; }
ul { margin: 0 0 3mm; padding-left: 5mm; } li { margin-bottom: 1.2mm; }
.lead { font-size: 11.5pt; } .small, figcaption { color: #52606d; font-size: 9pt; }
.warning { background: #fff7e6; border-left: 4px solid #d9922b; padding: 2.5mm 4mm;
  break-inside: avoid; }
figure { margin: 3mm 0 4mm; }
.chart, .chart-alone { break-inside: avoid; }
figcaption { margin-top: 1mm; break-before: avoid; break-inside: avoid; }
.charts { display: flex; flex-wrap: wrap; gap: 3mm; }
.charts .chart { flex: 1 1 45%; min-width: 70mm; max-width: 50%; }
.chart svg, .chart-alone svg { display: block; width: 100%; height: auto; }
table { border-collapse: collapse; font-size: 9pt; margin: 1mm 0 4mm; width: 100%;
  break-inside: avoid; font-variant-numeric: tabular-nums; }
table.long { break-inside: auto; } tr { break-inside: avoid; }
th, td { white-space: nowrap; padding: 1.1mm 1.8mm; border-bottom: 1px solid #e3e7ec;
  text-align: right; }
thead th, thead td { border-bottom: 1.5px solid #1f2933; font-weight: 600; vertical-align: bottom; }
tbody th { font-weight: inherit; }
th:first-child, td:first-child, td.text, th.text { text-align: left; white-space: normal; }
table.wide { font-size: 8pt; } .wide th, .wide td { padding: 1.1mm 0.9mm; }
.wide thead th { white-space: normal; }
.tasks th:first-child, .tasks td:first-child { white-space: nowrap; }
thead th.group, thead td.group { text-align: center; border-bottom: 1px solid #9aa5b1; }
td.marginal { font-weight: 600; }
.total { text-align: center; font-weight: 700; border-top: 1.5px solid #1f2933; }
caption { text-align: left; font-weight: 600; padding-bottom: 1mm; }
footer { margin-top: 10mm; padding-top: 2mm; border-top: 1px solid #cbd2d9; color: #6b7785;
  font-size: 8.5pt; }
@media print { body { padding: 0; max-width: none; font-size: 9.5pt; } h2 { margin-top: 6mm; } }
"""


def page(title: str, subtitle: str, sections: Sequence[str], footer: str) -> str:
    """Return the whole page; the sections are HTML, the other arguments plain text."""
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>{html.escape(title)}</title>
<style>{STYLE}</style>
</head>
<body>
<header><div class="kind">RASTrainer study report</div><h1>{html.escape(title)}</h1>
<div class="small">{html.escape(subtitle)}</div></header>
{"".join(part for part in sections if part)}
<footer>{html.escape(footer)}</footer>
</body>
</html>
"""
