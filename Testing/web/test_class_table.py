"""The table of a class in a browser, served by the command: sorted, updated, printed, outlived."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.database.study import Study
from Testing.simulator.board.class_study import play_class
from Testing.web.chromium import accessibility_checker, open_board_page, wait_for
from Testing.web.test_page_access import VIOLATIONS

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
def open_class(browser, folder: Path, *options: str, locale: str = "en-US") -> Iterator:
    """Yield the page of a board that the command serves."""
    command = (*COMMAND, "--config", str(folder / "teacher"), *options)
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            url, code = LINE.search(process.stdout.readline()).groups()
            page = open_board_page(browser, url, code, locale)
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
    with open_class(browser, tmp_path, "--study", str(study)) as page:
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


@pytest.mark.soak
def test_while_the_study_is_unreachable_the_page_says_so_once_and_keeps_the_table(
    browser, tmp_path, study
):
    with open_class(browser, tmp_path, "--study", str(study)) as page:
        page.wait_for_selector("#class tbody tr")
        assert page.locator("#class-age").is_hidden()
        page.emulate_media(media="print")
        assert page.locator("#class-age").is_visible()
        assert page.locator("#seats").is_hidden()
        page.emulate_media(media="screen")
        away = study.rename(study.with_suffix(".away"))
        page.wait_for_selector("#class-problem:has-text('There is no file')")
        assert "The table is as of" in page.inner_text("#class-age")
        assert trainees(page) == SORTED
        page.evaluate(accessibility_checker())
        assert page.evaluate(VIOLATIONS) == []
        away.rename(study)
        wait_for(page, "document.getElementById('class-problem').hidden")


@pytest.mark.soak
def test_without_trainees_a_curriculum_or_a_study_a_message_is_shown(browser, tmp_path):
    path = tmp_path / "study.db"
    Study.open(path).close()
    with open_class(browser, tmp_path, "--study", str(path)) as page:
        page.wait_for_selector("#class-state:has-text('The study has no active trainees yet.')")
        with Study.open(path) as opened:
            opened.create_trainee("T1")
        page.wait_for_selector("#class-state:has-text('No trainee of this study follows')")
        play_class(tmp_path / "other.db", ["T1"], 0)
        with Study.open(tmp_path / "other.db") as other, Study.open(path) as opened:
            own = CurriculumStore(other).standing("T1").curriculum
            opened.create_trainee("T2")
            CurriculumStore(opened).choose(own, "T2")
        page.wait_for_selector("#class-without:has-text('Without a curriculum: T1')")
        assert trainees(page) == ["T2"]
    with open_class(browser, tmp_path, locale="zh-CN") as page:
        page.wait_for_selector("#class-state:has-text('rastrainer board --study STUDY')")
        page.evaluate(accessibility_checker())
        assert page.evaluate(VIOLATIONS) == []
