"""Whether the page for browsers and headsets is there."""

from __future__ import annotations

from collections.abc import Iterator

from rastrainer_simulator.doctor.finding import Finding, Verdict
from rastrainer_simulator.view_server.page import page_folder


def check_page() -> Iterator[Finding]:
    """Look for the built page."""
    folder = page_folder()
    if folder is not None:
        yield Finding("page", Verdict.OK, f"The page for browsers and headsets is in {folder}.")
        return
    told = "The page for browsers and headsets is not built; the window needs none."
    yield Finding("page", Verdict.WARNING, told, "Build it: make page")
