"""The report of a study: one HTML page, and its numbers as a CSV file."""

from __future__ import annotations

import html
import itertools
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from pathlib import Path

import rastrainer
from rastrainer.files.writing import make_folder, write_text
from rastrainer.number_text import counted
from rastrainer.report import page
from rastrainer.report.calibration import calibration
from rastrainer.report.comparisons import ModeComparison, compare_modes, compared_method
from rastrainer.report.learning import learning
from rastrainer.report.method_comparison import method_comparison, shifted_skin
from rastrainer.report.mode_comparison import distributions, mode_comparison, motion
from rastrainer.report.paired_statistics import findings, order_caveat, paired_statistics
from rastrainer.report.passing import passing, started_trials
from rastrainer.report.procedures import procedures
from rastrainer.report.published_tables import paper_notes, published_tables, with_ctps
from rastrainer.report.raters import raters
from rastrainer.report.statistical_methods import FEW_SUBJECTS, limits, methods
from rastrainer.report.trainees import curricula, groups, questionnaires
from rastrainer.report.variation import variation
from rastrainer.statistics.intervals import scipy_module
from rastrainer.study.outcomes import MAIN_OUTCOMES, MOTION_OUTCOMES, mode_title
from rastrainer.study.study_data import StudyData
from rastrainer.study.tidy_csv import trials_csv

PAGE, NUMBERS = "report.html", "trials.csv"


@dataclass(frozen=True)
class WrittenReport:
    """The files of a report."""

    page: Path
    numbers: Path


def write_report(data: StudyData, folder: Path, made_utc: str | None = None) -> WrittenReport:
    """Write the report of a study into a folder.

    Args:
        folder: Created if missing; files of an earlier report are replaced.
    """
    page_text = report_html(data, made_utc)
    make_folder(folder)
    written = WrittenReport(folder / PAGE, folder / NUMBERS)
    write_text(written.page, page_text)
    write_text(written.numbers, trials_csv(data.trials))
    return written


def report_html(data: StudyData, made_utc: str | None = None) -> str:
    """Return the page."""
    # Before anything that catches `InputError`.
    scipy_module("stats")
    by_method, compared_methods = methods_note(data), method_comparison(data)
    skin = shifted_skin(data)
    data = with_ctps(with_one_method(data))
    pairs = list(itertools.combinations(sorted(data.modes), 2))
    main = [compare_modes(data, MAIN_OUTCOMES, *pair) for pair in pairs]
    described = [compare_modes(data, MOTION_OUTCOMES, *pair) for pair in pairs]
    everything = [comparison for comparisons in main for comparison in comparisons]
    made = made_utc or datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M UTC")
    modes = ", ".join(mode_title(mode) for mode in data.modes)
    subtitle = (
        f"{counted(len(data.trainees), 'trainee')} · {counted(len(data.trials), 'trial')} · "
        f"{counted(len(data.tasks), 'task')} · "
        f"{modes} · made {made}"
    )
    sections = [
        _summary(everything, data.gap, by_method),
        started_trials(data),
        published_tables(data),
        mode_comparison(data),
        *(paired_statistics(comparisons) for comparisons in main),
        distributions(data),
        learning(data),
        variation(data),
        passing(data),
        curricula(data),
        calibration(data),
        compared_methods,
        skin,
        procedures(data),
        motion(data, described[0] if described else ()),
        raters(data),
        questionnaires(data),
        groups(data),
        limits(data, everything),
        paper_notes(data),
        methods(data),
    ]
    footer = (
        f"RASTrainer {rastrainer.__version__}. For teaching and research; not a medical device. "
        "Trainees are named by pseudonyms only."
    )
    return _page(data.title, subtitle, sections, footer)


def _summary(comparisons: list[ModeComparison], gap: str, *left_out: str) -> str:
    sentences = findings(comparisons)
    n = max((len(comparison.trainees) for comparison in comparisons), default=0)
    parts = [page.bullets(sentences)] if sentences else []
    if 0 < n < FEW_SUBJECTS:
        few = (
            f"Only {counted(n, 'trainee')} did both modes. What is not shown here may still be "
            "there; see “What cannot be concluded”."
        )
        parts.append(page.paragraph(few, "warning"))
    if sentences and (caveat := order_caveat(comparisons)):
        parts.append(page.paragraph(caveat, "warning"))
    if not parts:
        parts = [
            page.paragraph("No trainee did two modes; the study is described, nothing is tested.")
        ]
    parts += [page.paragraph(note, "warning") for note in left_out if note]
    if gap:
        parts.insert(
            0, page.paragraph(f"{gap} What follows is about these trials alone.", "warning")
        )
    return page.section("In short", *parts)


def with_one_method(data: StudyData) -> StudyData:
    """Return the study with the trials of the compared method only, finished and aborted."""
    method = compared_method(data)
    return replace(
        data,
        trials=tuple(t for t in data.trials if t.method == method),
        aborted=tuple(stored for stored in data.aborted if stored.record.method == method),
    )


def methods_note(data: StudyData) -> str:
    """Return which trials `with_one_method` leaves out; "" if none."""
    compared = compared_method(data)
    started = [trial.method for trial in data.trials]
    started += [stored.record.method.value for stored in data.aborted]
    left_out = Counter(method for method in started if method != compared)
    if not left_out:
        return ""
    others = " and ".join(
        f"{counted(count, 'trial')} by {method}" for method, count in sorted(left_out.items())
    )
    return (
        f"Trials by different methods of registration have other points, times and residuals: "
        f"but for “Methods of registration”, which compares their errors, this report is about "
        f"those by {compared} and leaves out {others}. trials.csv has all of them, each with its "
        "method."
    )


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
.total:last-child { text-align: right; }
caption { text-align: left; font-weight: 600; padding-bottom: 1mm; }
footer { margin-top: 10mm; padding-top: 2mm; border-top: 1px solid #cbd2d9; color: #6b7785;
  font-size: 8.5pt; }
@media screen and (max-width: 190mm) { body { padding: 4mm; } section { overflow-x: auto; } }
@media print { body { padding: 0; max-width: none; font-size: 9.5pt; } h2 { margin-top: 6mm; } }
"""


def _page(title: str, subtitle: str, sections: Sequence[str], footer: str) -> str:
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
