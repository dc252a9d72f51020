"""`python -m Testing.error_rates [--write]`: simulate again how often the statistics err.

Prints the tables of `tables.md`, each with its requirements, in a few minutes on one core;
`--write` puts them into the page. The exit status is 1 if a requirement does not hold.
"""

from __future__ import annotations

import argparse
import sys

from Testing.error_rates.measured import markdown
from Testing.error_rates.page import PAGE, SETS, TABLES, with_table


def main() -> int:
    """Run all simulations."""
    parser = argparse.ArgumentParser(prog="python -m Testing.error_rates", description=__doc__)
    parser.add_argument("--sets", type=int, default=SETS, help="data sets of each case")
    parser.add_argument("--write", action="store_true", help="put the tables into the page")
    parser.add_argument("--only", choices=TABLES, help="one table")
    arguments = parser.parse_args()
    text, status = PAGE.read_text(encoding="utf-8"), 0
    for name, (header, simulate) in TABLES.items():
        if arguments.only not in (None, name):
            continue
        found = simulate(arguments.sets)
        table = markdown(header, found)
        print(f"{name}\n{table}\n", flush=True)
        for one in found:
            if not one.holds():
                print(f"does not hold: {one}", file=sys.stderr)
                status = 1
        text = with_table(name, text, table)
    if arguments.write:
        PAGE.write_text(text, encoding="utf-8")
    return status


if __name__ == "__main__":
    sys.exit(main())
