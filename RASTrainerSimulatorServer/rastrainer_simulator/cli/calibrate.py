"""`rastrainer calibrate`: the virtual hand next to measurements of people."""

from __future__ import annotations

import argparse
from dataclasses import asdict

from rastrainer.number_text import significant
from rastrainer_simulator.cli.printing import json_text, text_table
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.virtual.calibration import calibrated


def calibrate(arguments: argparse.Namespace) -> int:
    found = calibrated(load_setup(None), arguments.repeats)
    outside = [one.name for one in found if not one.holds]
    if arguments.json:
        print(json_text({"quantities": [asdict(one) for one in found], "outside": outside}))
    else:
        rows = [
            [
                f"{one.name}, {one.unit}".removesuffix(", "),
                significant(one.simulated),
                f"{one.least:g} to {one.most:g}",
                f"fitted by {one.fitted}" if one.fitted else "held out",
                "yes" if one.holds else "NO",
            ]
            for one in found
        ]
        print(text_table(["quantity", "simulated", "published", "", "in the range"], rows))
        print("\nPublished in:", *(f"  {one.name}: {one.source}" for one in found), sep="\n")
    return 1 if outside else 0
