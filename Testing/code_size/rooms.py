"""How large the product is: lines and functions of each room, as `docs/design.md` counts them."""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PRODUCT = ("RASTrainer", "RASTrainerSimulatorServer", "tools", "assets")
NOT_OURS = {".venv", "node_modules", "build", "dist"}


def product_files() -> list[Path]:
    """Return the product's files of Python: module, simulator, tools and assets."""
    files = (path for folder in PRODUCT for path in (ROOT / folder).rglob("*.py"))
    return sorted(path for path in files if not NOT_OURS & set(path.parts))


def room_of(path: Path) -> str:
    """Return the folder that a file belongs to, such as `rastrainer/slicer/scene`."""
    parts = path.relative_to(ROOT).parts[:-1]
    for package in ("rastrainer", "rastrainer_simulator", "rastrainer_headless"):
        if package in parts:
            return "/".join(parts[parts.index(package) :][:3])
    return parts[0]


def print_rooms() -> None:
    """Print lines, files and functions of each room, and of the product."""
    lines: Counter[str] = Counter()
    files: Counter[str] = Counter()
    functions: Counter[str] = Counter()
    for path in product_files():
        text = path.read_text(encoding="utf-8")
        room = room_of(path)
        lines[room] += text.count("\n")
        files[room] += 1
        functions[room] += sum(
            isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
            for node in ast.walk(ast.parse(text))
        )
    print(f"{'room':48}{'lines':>8}{'files':>7}{'functions':>11}")
    for room in sorted(lines):
        print(f"{room:48}{lines[room]:8,}{files[room]:7}{functions[room]:11,}")
    print(f"{'product':48}{lines.total():8,}{files.total():7}{functions.total():11,}")
    for name in ("Testing", "RASTrainerSimulatorServer/web/src"):
        texts = [
            path.read_text(encoding="utf-8")
            for pattern in ("*.py", "*.ts")
            for path in (ROOT / name).rglob(pattern)
            if not NOT_OURS & set(path.parts)
        ]
        print(f"{name:48}{sum(text.count(chr(10)) for text in texts):8,}{len(texts):7}")
