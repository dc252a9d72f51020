"""Release, workflows, soak, security page and types of the page say what the code says."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
import yaml

from rastrainer import __version__
from Testing import soak
from tools.page_types import FILE, page_types

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


WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
PHONY = set(re.search(r"^\.PHONY: (.*)$", MAKEFILE, re.MULTILINE).group(1).split())


def steps(workflow: Path) -> list[dict]:
    """Return the steps of all jobs of a workflow."""
    jobs = yaml.safe_load(workflow.read_text(encoding="utf-8"))["jobs"].values()
    return [step for job in jobs for step in job["steps"]]


@pytest.mark.parametrize("workflow", WORKFLOWS, ids=lambda path: path.stem)
def test_a_workflow_calls_pinned_actions_and_existing_targets_and_may_only_read(workflow):
    actions = [step["uses"] for step in steps(workflow) if "uses" in step]
    assert actions
    assert [action for action in actions if not re.fullmatch(r"[^@]+@[0-9a-f]{40}", action)] == []
    runs = [step["run"] for step in steps(workflow) if step.get("run", "").startswith("make ")]
    called = {target for run in runs for target in re.findall(r"\bmake ([a-z]+)", run)}
    assert called
    assert called <= PHONY
    content = yaml.safe_load(workflow.read_text(encoding="utf-8"))
    assert content["permissions"] == {"contents": "read"}
    assert all("timeout-minutes" in job for job in content["jobs"].values())


PAGE = (ROOT / "SECURITY.md").read_text(encoding="utf-8")
NAMED = sorted(set(re.findall(r"`(Testing/[\w/]+\.py)`", PAGE)))


def test_each_row_of_the_tables_names_a_file_of_tests():
    for file in NAMED:
        assert re.search(r"^def test_", (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE)
    rows = [line for line in PAGE.splitlines() if line.startswith("| ") and "---" not in line]
    guarded = [row for row in rows if not row.endswith("| tests |")]
    assert len(guarded) > 20
    assert all("/test_" in row.split(" | ")[-1] for row in guarded)


def test_every_file_of_attacks_is_named_on_the_page():
    files = {f"Testing/security/{path.name}" for path in (ROOT / "Testing/security").glob("test_*")}
    assert files <= set(NAMED)


def test_the_page_has_the_messages_and_constants_of_the_simulator():
    assert FILE.read_text(encoding="utf-8") == page_types(), "run make page"


MARKED = [
    path.relative_to(soak.ROOT).as_posix()
    for path in (soak.ROOT / "Testing").rglob("test_*.py")
    if "mark.soak" in path.read_text(encoding="utf-8")
]


def test_each_part_has_tests_and_each_test_is_in_a_part():
    places = [place for part in soak.PARTS for place in part.places]
    assert all((soak.ROOT / "Testing" / place).exists() for place in places)
    assert len(set(places)) == len(places)
    parts = [set(soak.files_of(part)) & set(MARKED) for part in soak.PARTS]
    assert all(parts)
    assert sorted(file for files in parts for file in files) == sorted(MARKED)
