"""Make the draft of a head from a volume.

    python -m rastrainer_headless.make_head VOLUME -o DIR [--threshold T] [--cut S]
        [--orientation LAS] [--no-skull] [--no-volume]

Standard output has a line such as ` 30%  Filling cavities` a step, and `Warning: …` lines. At the
line `The head is made.` DIR holds the draft without its skull, which is put there at the end. Exit
status: 0 made, 2 the volume cannot be used (standard error has the sentence).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.scenario.writer import HeadDraft, new_folder, write_draft
from rastrainer.work_progress import HEAD_MADE, allow_any_text, print_progress, print_warning


def main(argv: Sequence[str] | None = None) -> int:
    allow_any_text()
    parser = argparse.ArgumentParser(prog="python -m rastrainer_headless.make_head")
    parser.add_argument("volume", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")
    parser.add_argument("--threshold", type=float, help="value that parts air from skin")
    parser.add_argument("--cut", type=float, metavar="S", help="height of the base, mm superior")
    parser.add_argument("--orientation", help="of a file that states none, such as LAS")
    parser.add_argument("--no-skull", action="store_true")
    parser.add_argument("--no-volume", action="store_true")
    arguments = parser.parse_args(argv)
    try:
        from rastrainer.slicer.head.head_draft import makeDraft
        from rastrainer.slicer.head.volume import HeadSettings
        from rastrainer_headless.volume_files import readVolume
    except ImportError as error:
        print(
            f"A head cannot be made here, {error.name} is missing: pip install slicer-core pydicom",
            file=sys.stderr,
        )
        return 2
    try:
        volume = readVolume(arguments.volume, arguments.orientation)
        settings = HeadSettings(threshold=arguments.threshold, baseMm=arguments.cut)

        def headMade(head: HeadDraft, warnings: list[str]) -> None:
            for warning in warnings:
                print_warning(warning)
            with new_folder(arguments.output) as folder:
                write_draft(folder, head)
            print(HEAD_MADE, flush=True)

        draft, _ = makeDraft(
            volume,
            settings,
            not arguments.no_skull,
            print_progress,
            headMade=headMade,
            hasVolume=not arguments.no_volume,
        )
        if draft.skull is not None:
            write_draft(arguments.output, draft)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
