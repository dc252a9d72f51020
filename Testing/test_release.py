"""A release is described the same everywhere: in its code, its changelog and its citation."""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path

import pytest
import yaml

from rastrainer import __version__

ROOT = Path(__file__).parents[1]


def newest_release() -> tuple[str, str]:
    """Return version and date of the changelog's newest heading that has both."""
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    return re.search(r"^## (\d+\.\d+\.\d+) – (\d{4}-\d\d-\d\d)$", changelog, re.MULTILINE).groups()


def citation() -> dict:
    """Return what CITATION.cff says."""
    return yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))


def test_code_changelog_and_citation_state_the_same_version_and_date():
    said = citation()
    assert newest_release() == (__version__, str(said["date-released"]))
    assert said["version"] == __version__


def test_the_citation_has_what_its_schema_requires_of_software_and_references():
    said = citation()
    assert said["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= set(said)
    assert said["type"] == "software"
    for reference in said["references"]:
        assert {"type", "title", "authors"} <= set(reference)
        for author in reference["authors"]:
            assert {"name"} <= set(author) or {"family-names", "given-names"} <= set(author)


def acknowledgement() -> str:
    """Return the text with which Slicer's module acknowledges what it builds on."""
    module = ast.parse((ROOT / "RASTrainer" / "RASTrainer.py").read_text(encoding="utf-8"))
    (text,) = [
        node.value.args[0].value
        for node in ast.walk(module)
        if isinstance(node, ast.Assign)
        and ast.unparse(node.targets[0]) == "parent.acknowledgementText"
    ]
    return text


def test_citation_readme_and_the_module_in_slicer_name_the_same_publications():
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    for text in (readme, acknowledgement()):
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


@pytest.mark.parametrize("name", ["MIT", "BSD-3-Clause", "LicenseRef-Colin27"])
def test_the_text_of_every_license_named_in_reuse_toml_is_there(name):
    assert name in (ROOT / "REUSE.toml").read_text(encoding="utf-8")
    assert (ROOT / "LICENSES" / f"{name}.txt").read_text(encoding="utf-8").strip()


def test_the_colin27_notice_is_the_same_in_notices_and_licenses():
    notice = (ROOT / "NOTICE.md").read_text(encoding="utf-8").replace("> ", "")
    license_text = (ROOT / "LICENSES" / "LicenseRef-Colin27.txt").read_text(encoding="utf-8")
    assert " ".join(license_text.split()) in " ".join(notice.split())
