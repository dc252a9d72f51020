"""The table of a class in a browser, served by the command: sorted, and updated."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from rastrainer.study.database.study import Study
from Testing.simulator.board.class_study import play_class
from Testing.web.chromium import open_board_page

COMMAND = (sys.executable, "-m", "rastrainer_simulator.cli.main", "board", "--port", "0")
LINE = re.compile(r"RASTrainer board is on (\S+), pairing code (\d{6});")
NAMES = ["T2", "T10", "T1", "<i>T3</i>"]
SORTED = ["<i>T3</i>", "T1", "T2", "T10"]


@pytest.fixture
def study(tmp_path) -> Path:
    path = tmp_path / "study.db"
    play_class(path, NAMES, 12)
    return path


@contextmanager
def open_class(browser, folder: Path, study: Path) -> Iterator:
    """Yield the page of a board that the command serves."""
    command = (*COMMAND, "--config", str(folder / "teacher"), "--study", str(study))
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            url, code = LINE.search(process.stdout.readline()).groups()
            page = open_board_page(browser, url, code)
            yield page
            assert page.problems == []
            page.context.close()
        finally:
            process.terminate()


def trainees(page) -> list[str]:
    return page.locator("#class tbody th").all_inner_texts()


def test_a_teacher_sorts_the_class_by_keyboard_and_a_change_in_the_study_is_shown(
    browser, tmp_path, study
):
    with open_class(browser, tmp_path, study) as page:
        page.wait_for_selector("#class tbody tr")
        assert trainees(page) == SORTED
        table = page.get_by_role("region", name="First steps").get_by_role("table")
        assert table.get_by_role("columnheader", name="Task 3 · trace over the skin").count() == 1
        assert table.get_by_role("rowheader", name="T10").count() == 1
        page.focus("#class thead button >> nth=1")
        page.keyboard.press("Enter")
        assert page.locator("#class [aria-sort]").inner_text() == "Reached"
        assert page.locator("#class [aria-sort=descending]").count() == 1
        best_first = trainees(page)
        page.keyboard.press("Space")
        assert page.locator("#class [aria-sort=ascending]").count() == 1
        assert trainees(page)[-1] == best_first[0]
        with Study.open(study) as opened:
            opened.create_trainee("T11")
        page.wait_for_selector("#class tbody th:has-text('T11')")
        assert page.locator("#class thead button:focus").inner_text() == "Reached"
        page.keyboard.press("Shift+Tab")
        page.keyboard.press("Shift+Tab")
        assert page.locator(".scroller:focus").count() == 1
