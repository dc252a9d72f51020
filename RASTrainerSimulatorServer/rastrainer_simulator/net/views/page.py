"""The browser page: built files where there are some, else how to build them."""

from __future__ import annotations

from pathlib import Path

_INSTALLED = Path(__file__).parents[2] / "web"
_CHECKOUT = Path(__file__).parents[3] / "web" / "dist"

NOT_BUILT = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>RASTrainer</title>
<h1>RASTrainer</h1>
<p>The simulator is running, but its browser page has not been built.</p>
<p>Build it with <code>make page</code>, or use the desktop window:
<code>rastrainer simulator --desktop</code>.</p>
</html>
"""


def page_folder() -> Path | None:
    """Return the folder of the built page; None where there is none."""
    for folder in (_INSTALLED, _CHECKOUT):
        if (folder / "index.html").is_file():
            return folder
    return None
