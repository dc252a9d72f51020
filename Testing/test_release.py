"""A release says the same of itself everywhere: in its code, its changelog and its citation."""

from __future__ import annotations

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


def test_the_citation_names_the_same_publications_as_the_readme():
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    for reference in citation()["references"]:
        assert reference["title"] in readme
        assert reference.get("doi", reference.get("url")) in readme


@pytest.mark.parametrize("name", ["MIT", "BSD-3-Clause", "LicenseRef-Colin27"])
def test_the_text_of_every_license_that_reuse_names_is_there(name):
    assert name in (ROOT / "REUSE.toml").read_text(encoding="utf-8")
    assert (ROOT / "LICENSES" / f"{name}.txt").read_text(encoding="utf-8").strip()


def test_the_notice_of_colin27_is_the_same_in_notices_and_licenses():
    notice = (ROOT / "NOTICE.md").read_text(encoding="utf-8").replace("> ", "")
    license_text = (ROOT / "LICENSES" / "LicenseRef-Colin27.txt").read_text(encoding="utf-8")
    assert " ".join(license_text.split()) in " ".join(notice.split())
