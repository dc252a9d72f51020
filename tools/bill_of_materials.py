"""Write what RASTrainer is made with as CycloneDX: build/rastrainer.cdx.json and the page's.

Made from the lock files alone, so the same locks give the same bills. Needs `cyclonedx-bom` for the
Python packages and npm for the page's packages.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import build_page

ROOT = Path(__file__).resolve().parents[1]
LOCK = ROOT / "requirements" / "base.lock"
BUILD = ROOT / "build"
PYTHON_BILL = BUILD / "rastrainer.cdx.json"
NO_VERSION = "0.0.0"
PAGE_BILL = BUILD / "rastrainer-page.cdx.json"


def write_python_bill() -> int:
    """Write the bill of the lock and return how many packages it names."""
    PYTHON_BILL.parent.mkdir(parents=True, exist_ok=True)
    project = ["--pyproject", str(ROOT / "pyproject.toml")]
    form = ["--output-reproducible", "--output-format", "JSON", "--output-file", str(PYTHON_BILL)]
    command = [sys.executable, "-m", "cyclonedx_py", "requirements", str(LOCK)]
    _run([*command, *project, *form])
    return _count(PYTHON_BILL)


def write_page_bill(output: Path = PAGE_BILL) -> int:
    """Write the bill of what goes into the page and return how many packages it names."""
    output.parent.mkdir(parents=True, exist_ok=True)
    node, npm = build_page.node_and_npm()
    words = ["sbom", "--package-lock-only", "--omit=dev", "--sbom-format=cyclonedx"]
    with tempfile.TemporaryDirectory() as temporary:
        # Its name is part of the bill.
        folder = Path(temporary) / "rastrainer-page"
        # Copies with a version, which npm needs for a bill and the page lacks.
        folder.mkdir()
        for name in ("package.json", "package-lock.json"):
            content = json.loads((build_page.WEB / name).read_text(encoding="utf-8"))
            content["version"] = NO_VERSION
            if "packages" in content:
                content["packages"][""]["version"] = NO_VERSION
            (folder / name).write_text(json.dumps(content), encoding="utf-8")
        text = _run([*npm, *words], cwd=folder, env=build_page.node_environment(node))
    bill = json.loads(text)
    # Differs from run to run.
    bill.pop("serialNumber", None)
    bill["metadata"].pop("timestamp", None)
    output.write_text(json.dumps(bill, indent=2) + "\n", encoding="utf-8")
    return _count(output)


def _count(bill: Path) -> int:
    return len(json.loads(bill.read_text(encoding="utf-8"))["components"])


def _run(command: list[str], **others: object) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False, **others)
    if done.returncode != 0:
        said = (done.stderr or done.stdout).strip().splitlines() or ["no reason given"]
        raise RuntimeError(f"{command[0]} {command[1]} has failed: {said[-1]}")
    return done.stdout


if __name__ == "__main__":
    try:
        for written, count in ((PYTHON_BILL, write_python_bill()), (PAGE_BILL, write_page_bill())):
            print(f"{written.relative_to(ROOT)} names {count} packages.")
    except RuntimeError as error:
        sys.exit(str(error))
