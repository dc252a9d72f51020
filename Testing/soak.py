"""Run the tests marked `soak` in parts of at most 20 minutes each: see `make soak`.

python -m Testing.soak            runs all parts, one after the other
python -m Testing.soak list       prints them
python -m Testing.soak 3          runs the third
"""

import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
LONGEST_TEST_S = 1200
"""Two hours of training, at eight times the speed, take 906 s."""


class Part(NamedTuple):
    """Some of the tests, with a sentence about them.

    A test file belongs to the part that names it, or the nearest folder that holds it. `minutes` is
    its last measured duration, on two processors that also ran another part. `processes` share
    tests that only compute.
    """

    name: str
    proves: str
    places: tuple[str, ...]
    minutes: int
    processes: int = 0

    def __str__(self) -> str:
        return f"{self.name}: {self.proves} ({self.minutes} min)."


PARTS = (
    Part(
        "formulas",
        "the registration's formulas and intervals hold for thousands of drawn trials",
        ("domain/registration", "error_rates/test_method_errors.py", "icp_peers"),
        1,
    ),
    Part(
        "study",
        "a study on PostgreSQL and with many writers stores everything exactly once",
        ("domain", "slicer", "simulator/board"),
        5,
    ),
    Part(
        "error rates",
        "warnings and limits err as rarely as documented",
        ("error_rates", "simulator/statistics"),
        20,
        processes=2,
    ),
    Part(
        "cohorts",
        "played cohorts resume after kills, with the same trials",
        ("simulator/virtual",),
        1,
    ),
    Part(
        "cheats",
        "cheating never helps",
        ("simulator/virtual/test_cheating_trainees.py", "simulator/training"),
        1,
    ),
    Part(
        "simulator",
        "collision, views, scenarios and flow hold on many heads, poses and languages",
        ("simulator",),
        15,
    ),
    Part(
        "attacks",
        "attacked links, streams and decoders stay up and within their limits",
        ("security", "."),
        14,
    ),
    Part(
        "headset",
        "eyes, hands and panels in an emulated headset",
        ("web/test_headset.py", "web/test_headset_panels.py"),
        2,
    ),
    Part(
        "page",
        "the page works in a browser, without keys, on a bad network and for spectators",
        ("web",),
        11,
    ),
    Part(
        "devices",
        "whole sessions by each device",
        ("web/test_whole_flow.py",),
        21,
    ),
    Part(
        "procedures",
        "a procedure and a trace, each by hand",
        ("web/test_procedure_by_hand.py", "web/test_surface_by_hand.py"),
        19,
    ),
    Part(
        "drill",
        "a drill of decisions by each device and by ear, with Slicer's side and without",
        ("web/test_whole_drill.py",),
        13,
    ),
    Part(
        "kills",
        "killed simulators, sides of Slicer and databases lose and double nothing",
        (
            "end_to_end/test_kills.py",
            "end_to_end/test_many_seats.py",
            "end_to_end/test_delivery.py",
        ),
        14,
    ),
    Part(
        "long run",
        "two hours of training leak no memory, at eight times the speed; a crowd is served",
        ("end_to_end/test_long_run.py", "end_to_end/test_crowd.py"),
        16,
    ),
    Part(
        "end to end",
        "scenarios, real heads, packages, exports and the tour of the module",
        ("end_to_end",),
        14,
    ),
)


def part_of(file: Path) -> Part:
    """Return the part of a test file."""
    inside = file.relative_to(ROOT / "Testing")
    above = [inside.as_posix(), *(folder.as_posix() for folder in inside.parents)]
    return next(part for place in above for part in PARTS if place in part.places)


def files_of(part: Part) -> list[str]:
    found = sorted((ROOT / "Testing").rglob("test_*.py"))
    return [str(file.relative_to(ROOT)) for file in found if part_of(file) is part]


def run(part: Part) -> int:
    """Run a part and return its exit status."""
    print(part, flush=True)
    command = [sys.executable, "-m", "pytest", "-m", "soak", "-q"]
    command += ["-o", f"faulthandler_timeout={LONGEST_TEST_S}"]
    if part.processes:
        command += ["-n", str(part.processes), "--dist", "worksteal"]
    return subprocess.run([*command, *files_of(part)], cwd=ROOT, check=False).returncode


def main(words: list[str]) -> int:
    if words == ["list"]:
        for number, part in enumerate(PARTS, start=1):
            print(f"{number:2}  {part}")
        return 0
    names = {name: part for n, part in enumerate(PARTS, 1) for name in (str(n), part.name)}
    if not set(words) <= set(names):
        print("PART is a number or a name of `make soak PART=list`.", file=sys.stderr)
        return 2
    return max([run(part) for part in ([names[word] for word in words] or PARTS)])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
