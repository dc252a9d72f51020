"""A release is described the same everywhere: in its code, its changelog and its citation."""

from __future__ import annotations

import json
import re
from pathlib import Path

import yaml

from rastrainer import __version__

ROOT = Path(__file__).parents[1]


def newest_release() -> tuple[str, str]:
    """Return version and date of the changelog's newest heading that has both."""
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    return re.search(r"^## (\d+\.\d+\.\d+) – (\d{4}-\d\d-\d\d)$", changelog, re.MULTILINE).groups()


def citation() -> dict:
    return yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))


def test_code_changelog_and_citation_state_the_same_version_and_date():
    said = citation()
    assert newest_release() == (__version__, str(said["date-released"]))
    assert said["version"] == __version__


def test_citation_readme_and_the_module_in_slicer_name_the_same_publications():
    module = (ROOT / "RASTrainer" / "RASTrainer.py").read_text(encoding="utf-8")
    joined = re.sub(r"""["']\s+["']""", "", module)
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    for text in (readme, joined):
        for reference in citation()["references"]:
            assert reference["title"] in text
            assert reference.get("doi", reference.get("url")) in text


def test_the_documentation_states_the_measured_simulator_sizes_that_the_module_shows():
    resources = ROOT / "RASTrainer" / "Resources" / "RASTrainerSimulator"
    measured = json.loads((resources / "sizes.json").read_text(encoding="utf-8"))
    columns = ("linux-x86_64", "win32-AMD64", "darwin-arm64", "darwin-x86_64")
    assert sorted(measured) == sorted(columns)
    page = (ROOT / "docs" / "how-to" / "use-slicer.md").read_text(encoding="utf-8")
    for title, key in (("downloaded, once", "downloadMB"), ("kept", "keptMB")):
        row = " | ".join(f"{measured[name][key]} MB" for name in columns)
        assert f"| {title} | {row} |" in page


def test_the_text_of_every_license_is_there_and_the_colin27_notice_is_the_same_in_both_places():
    for name in ("MIT", "BSD-3-Clause", "LicenseRef-Colin27"):
        assert name in (ROOT / "REUSE.toml").read_text(encoding="utf-8")
        text = (ROOT / "LICENSES" / f"{name}.txt").read_text(encoding="utf-8")
        assert text.strip()
    notice = (ROOT / "NOTICE.md").read_text(encoding="utf-8").replace("> ", "")
    assert " ".join(text.split()) in " ".join(notice.split())
