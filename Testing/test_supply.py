"""What RASTrainer is made of: pinned by hashes, and listed in the wheel's notices."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterable
from importlib import import_module
from itertools import pairwise
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
REQUIREMENTS = ROOT / "requirements"
LOCKS = sorted(REQUIREMENTS.glob("*.lock"))
RESOURCES = ROOT / "RASTrainer" / "Resources" / "RASTrainerSimulator"
SIMULATORS_LOCK = RESOURCES / "requirements.lock"
LEFT_OUT = ROOT / "tools" / "simulator-leaves-out.txt"
PACKAGE_LOCK = ROOT / "RASTrainerSimulatorServer" / "web" / "package-lock.json"
sys.path.insert(0, str(ROOT / "tools"))
wheel_page = import_module("wheel_page")

EXTRAS = {
    "base.lock": ("page", "slicer"),
    "test.lock": ("test",),
    "bench.lock": ("bench",),
    "soak.lock": ("soak",),
    "supply.lock": ("supply",),
    "docs.lock": ("docs",),
}
"""What `make lock` makes each lock from, besides the project's own dependencies."""
PEERS_LOCKS = tuple(REQUIREMENTS / f"{name}.lock" for name in ("ralph", "icp"))
"""Peers in the tests have their own environments and requirements files."""
NAME = re.compile(r"^([A-Za-z0-9._-]+)(?:\[([^]]*)\])?")

ENTRY = re.compile(r"^[a-z0-9][a-z0-9._-]*==[^\s\\]+(?: ; [^\\]+)? \\$")
HASH = re.compile(r"^    --hash=sha256:[0-9a-f]{64}(?: \\)?$")


def _kind(line: str) -> str:
    if ENTRY.match(line):
        return "entry"
    return "hash" if HASH.match(line) else line


@pytest.mark.parametrize("lock", [*LOCKS, SIMULATORS_LOCK], ids=lambda lock: lock.stem)
def test_every_locked_package_is_pinned_by_hashes_and_by_no_address(lock):
    lines = lock.read_text(encoding="utf-8").splitlines()
    kinds = [_kind(line) for line in lines]
    assert set(kinds) == {"entry", "hash"}
    assert all(after == "hash" for kind, after in pairwise(kinds) if kind == "entry")
    packages = json.loads(PACKAGE_LOCK.read_text(encoding="utf-8"))["packages"]
    assert all("integrity" in entry for place, entry in packages.items() if place)
    assert not any("resolved" in entry for entry in packages.values())


def asked_for(project: dict, extras: Iterable[str]) -> set[str]:
    """Return the names of the packages that the project and some extras ask for."""
    names = set()
    optional = project["optional-dependencies"]
    for line in [*project["dependencies"], *(line for extra in extras for line in optional[extra])]:
        name, others = NAME.match(line).groups()
        if name == project["name"]:
            names |= asked_for(project, others.split(","))
        else:
            names.add(re.sub(r"[-_.]+", "-", name).lower())
    return names


@pytest.mark.skipif(sys.version_info < (3, 11), reason="the standard library reads no TOML")
def test_each_lock_and_that_of_the_simulator_hold_what_the_project_requires():
    import tomllib

    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert {lock.name for lock in LOCKS} == {*EXTRAS, *(lock.name for lock in PEERS_LOCKS)}
    asked = {name: asked_for(project, extras) for name, extras in EXTRAS.items()}
    asked |= {lock.name: asked_of(lock.with_suffix(".in")) for lock in PEERS_LOCKS}
    for lock in LOCKS:
        locked = set(re.findall(r"^([a-z0-9._-]+)==", lock.read_text(encoding="utf-8"), re.M))
        assert asked[lock.name] - locked == set(), lock.name
    names = {pin.split("==")[0] for pin in pinned(SIMULATORS_LOCK)}
    assert asked_for(project, ()) - names == set()


def asked_of(requirements: Path) -> set[str]:
    """Return the names of the packages in a file of requirements."""
    lines = requirements.read_text(encoding="utf-8").splitlines()
    return {NAME.match(line).group(1) for line in lines if not line.startswith("#")}


def pinned(lock: Path) -> dict[str, set[str]]:
    """Return the hashes of each `name==version` of a lock, for all platforms."""
    pins: dict[str, set[str]] = {}
    for line in lock.read_text(encoding="utf-8").splitlines():
        if not line.startswith(" "):
            hashes = pins.setdefault(line.split()[0], set())
        else:
            hashes.add(line.strip(" \\"))
    return pins


def test_slicer_sets_up_the_simulator_from_what_is_tested_minus_what_it_never_imports():
    ours, whole = pinned(SIMULATORS_LOCK), pinned(REQUIREMENTS / "base.lock")
    assert {name: whole.get(name) for name in ours} == ours
    lines = LEFT_OUT.read_text(encoding="utf-8").splitlines()
    left_out = {line for line in lines if not line.startswith("#")}
    names = {pin.split("==")[0] for pin in ours}
    assert names & left_out == set()
    assert left_out <= {pin.split("==")[0] for pin in whole}


def test_a_wheel_includes_the_notices_of_what_its_page_is_made_of(tmp_path):
    build_data = {"force_include": {}}
    hook = wheel_page.WheelPage(str(ROOT), {}, None, None, str(tmp_path), "wheel")
    hook.initialize("standard", build_data)
    (folder,) = build_data["force_include"]
    notices = Path(folder, "third-party-notices.txt").read_text(encoding="utf-8")
    assert re.search(r"^three \d\S*\nLicense: MIT", notices, re.MULTILINE)
    assert "Permission is hereby granted" in notices
