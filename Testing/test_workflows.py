"""The hosted workflows run what a contributor runs, with pinned programs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
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


def test_windows_is_tested_with_the_kinematics_available_there():
    text = (ROOT / ".github" / "workflows" / "test.yml").read_text(encoding="utf-8")
    jobs = yaml.safe_load(text)["jobs"]
    systems = {entry["system"]: entry for entry in jobs["desktop"]["strategy"]["matrix"]["include"]}
    assert systems["windows-latest"]["kinematics"] == "numpy"
    assert "macos-latest" in systems


def test_the_pre_commit_hooks_are_make_targets_of_this_repository():
    text = (ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8")
    (repository,) = yaml.safe_load(text)["repos"]
    assert repository["repo"] == "local"
    entries = {hook["entry"] for hook in repository["hooks"]}
    assert entries == {"make lint", "make test"}
