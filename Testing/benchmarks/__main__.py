"""`make bench`: run every benchmark, print one table, write build/bench.json.

A benchmark is a file `bench_*.py` here with a function `rows(quick: bool) -> list[dict]`; each row
has the keys of `COLUMNS`, with None if there is no peer. Before each stands how busy and how fast
the machine is.
"""

import argparse
import importlib
import json
from pathlib import Path

from Testing.benchmarks.row import host_row, load_row

COLUMNS = ("name", "median", "p99", "unit", "peer", "peer_median", "peer_p99", "success", "n")
HERE = Path(__file__).parent


def main() -> None:
    parser = argparse.ArgumentParser(prog="make bench", description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="benchmarks to run (default: all)")
    parser.add_argument("--quick", action="store_true", help="fewer repetitions, rougher numbers")
    parser.add_argument("--output", type=Path, default=Path("build/bench.json"))
    arguments = parser.parse_args()
    found = sorted(path.stem.removeprefix("bench_") for path in HERE.glob("bench_*.py"))
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    rows = []
    print(_line(COLUMNS))
    for name in arguments.names or found:
        module = importlib.import_module(f"Testing.benchmarks.bench_{name}")
        machine = [load_row(name), host_row(name)]
        for row in (*machine, *module.rows(arguments.quick)):
            rows.append({column: row[column] for column in COLUMNS})
            print(_line(rows[-1].values()), flush=True)
        # A failure of the last benchmark should not lose half an hour's numbers.
        arguments.output.write_text(json.dumps(rows, indent=2) + "\n")
    print(f"Written to {arguments.output}.")


def _line(cells) -> str:
    texts = [f"{cell:.4g}" if isinstance(cell, float) else str(cell or "") for cell in cells]
    widths = (26, 10, 10, 6, 27, 12, 12, 9, 8)
    return " ".join(text.ljust(width) for text, width in zip(texts, widths, strict=True))


if __name__ == "__main__":
    main()
