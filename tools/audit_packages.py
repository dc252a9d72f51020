"""Check the lock files for known vulnerabilities.

Exit status 0: nothing is known. 1: something is, or an answer cannot be read. 3: the service cannot
be reached from here.
"""

import json
import subprocess
import sys
from pathlib import Path

import build_page

ROOT = Path(__file__).resolve().parents[1]
LOCKS = tuple(sorted((ROOT / "requirements").glob("*.lock")))
TIMEOUT_S = 300
NOTHING_KNOWN, VULNERABLE, NOT_CHECKED = 0, 1, 3


def audit_python(lock: Path) -> tuple[int, str]:
    """Check the packages of a lock; return the status and a sentence."""
    words = ["--require-hashes", "--disable-pip", "--progress-spinner=off", "--format=json"]
    command = [sys.executable, "-m", "pip_audit", *words, "-r", str(lock), "--timeout", "15"]
    return _judged(lock.name, command, _python_findings)


def audit_page() -> tuple[int, str]:
    """Check the packages of the page; return the status and a sentence."""
    node, npm = build_page.node_and_npm()
    command = [*npm, "audit", "--package-lock-only", "--json", "--fetch-retries=0"]
    where = {"cwd": build_page.WEB, "env": build_page.node_environment(node)}
    return _judged("package-lock.json", command, _page_findings, **where)


def _judged(name: str, command: list[str], findings: object, **others: object) -> tuple[int, str]:
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=TIMEOUT_S, check=False, **others
        )
        found = findings(json.loads(done.stdout))
    except (subprocess.TimeoutExpired, ValueError, KeyError, TypeError):
        return NOT_CHECKED, f"{name}: not checked; the service cannot be reached from here."
    if found:
        return VULNERABLE, "\n".join(f"{name}: {finding}" for finding in found)
    return NOTHING_KNOWN, f"{name}: nothing is known about any of its packages."


def _python_findings(answer: dict) -> list[str]:
    skipped = [package["name"] for package in answer["dependencies"] if "skip_reason" in package]
    if skipped:
        # An index that answers and knows none of them is a mirror without the advisories.
        raise ValueError(f"{len(skipped)} packages could not be looked up")
    return [
        f"{package['name']} {package['version']}: {known['id']}, fixed in "
        f"{', '.join(known['fix_versions']) or 'no version yet'}"
        for package in answer["dependencies"]
        for known in package.get("vulns", ())
    ]


def _page_findings(answer: dict) -> list[str]:
    found = answer["vulnerabilities"].values()
    return [f"{package['name']}: {package['severity']}" for package in found]


def main() -> int:
    """Check everything, print the results, and return the worst status."""
    answers = [audit_python(lock) for lock in LOCKS] + [audit_page()]
    for _status, sentence in answers:
        print(sentence)
    statuses = {status for status, _sentence in answers}
    return VULNERABLE if VULNERABLE in statuses else max(statuses)


if __name__ == "__main__":
    sys.exit(main())
