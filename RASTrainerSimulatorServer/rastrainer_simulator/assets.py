"""Where to find the robot, scenarios, studies and browser page that come with RASTrainer."""

from __future__ import annotations

from pathlib import Path

_INSTALLED = Path(__file__).parent / "assets"
_CHECKOUT = Path(__file__).parents[2] / "assets"
_INSTALLED_PAGE = Path(__file__).parent / "web"
_CHECKOUT_PAGE = Path(__file__).parents[1] / "web" / "dist"


def asset_path(*parts: str) -> Path:
    """Return the path of a file or folder that comes with RASTrainer.

    A wheel carries the assets inside the package; a checkout keeps them in its root.
    """
    root = _INSTALLED if _INSTALLED.is_dir() else _CHECKOUT
    return root.joinpath(*parts)


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
    """Return the folder of the built page, if there is one."""
    for folder in (_INSTALLED_PAGE, _CHECKOUT_PAGE):
        if (folder / "index.html").is_file():
            return folder
    return None
