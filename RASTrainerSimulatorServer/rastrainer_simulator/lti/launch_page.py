"""The page after a launch: the user's pseudonym, what to do, and the user's scores."""

from __future__ import annotations

import base64
import hashlib
import html
import re

from rastrainer.number_text import with_units
from rastrainer.study.outcomes import task_title
from rastrainer.study.study_data import TrialRow
from rastrainer_simulator.lti.course_study import CourseMember
from rastrainer_simulator.lti.launch_message import MODES, GradeRule, GradeTerms, PlatformLaunch
from rastrainer_simulator.texts.texts import LANGUAGES, Texts

MOST_TRIALS = 50
STYLE = """
:root { font: 17px / 1.45 system-ui, "Segoe UI", Roboto, "Noto Sans", sans-serif;
  color: #f4f7fb; background: #0e1726; }
* { box-sizing: border-box; margin: 0; padding: 0; }
body { max-width: 46rem; margin: 0 auto; padding: 24px clamp(12px, 4vw, 32px) 48px;
  overflow-wrap: anywhere; }
h1 { font-size: 24px; margin-bottom: 16px; }
h2 { font-size: 19px; margin: 28px 0 8px; }
p + p { margin-top: 8px; }
.who { padding: 16px 20px; background: #1b273a; border: 1px solid rgb(255 255 255 / 22%);
  border-left: 8px solid #8ff0d0; border-radius: 12px; }
.who strong { display: block; font-size: 34px; line-height: 1.25; }
ol { padding-left: 1.5em; }
.soft { color: #b9c5d6; font-size: 15px; }
ul { list-style: none; margin-top: 12px; }
li.trial { padding: 12px 0; border-top: 1px solid rgb(255 255 255 / 22%); }
li.trial p { display: flex; flex-wrap: wrap; justify-content: space-between; gap: 0 16px; }
dl { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 10rem), 1fr));
  gap: 4px 16px; margin-top: 4px; font-size: 15px; font-variant-numeric: tabular-nums; }
dt { color: #b9c5d6; }
code { display: block; margin-top: 12px; padding: 12px 16px; background: #1b273a;
  border-radius: 9px; font-size: 15px; }
"""
_STYLE_HASH = base64.b64encode(hashlib.sha256(STYLE.encode()).digest()).decode()
PAGE_HEADERS = {
    "Content-Security-Policy": (
        f"default-src 'none'; style-src 'sha256-{_STYLE_HASH}'; img-src data:; base-uri 'none'; "
        "form-action 'none'; frame-ancestors 'none'"
    ),
    "Cache-Control": "no-store",
}


class LaunchPage:
    """Writes pages in one language; whatever comes from elsewhere is text in them, never markup."""

    def __init__(self, language: str) -> None:
        self._language = language
        self._texts = Texts(LANGUAGES[language])

    @classmethod
    def in_language_of(cls, wanted: str) -> LaunchPage:
        """Return the pages in the first available language of an Accept-Language.

        A platform may write `de_AT` instead of `de-AT`, as Moodle does.
        """
        known = {tag.partition("-")[0]: tag for tag in LANGUAGES}
        tags = re.findall(r"(?:^|,)\s*([A-Za-z]{2})(?![A-Za-z])", wanted[:200])
        return cls(next((known[tag.lower()] for tag in tags if tag.lower() in known), "en"))

    def for_learner(self, launch: PlatformLaunch, member: CourseMember) -> str:
        """Return the page of a learner."""
        parts = [
            f'<p class="who">{self._say("lti.you are")}<strong>{html.escape(member.pseudonym)}'
            "</strong></p>",
            f"<h2>{self._say('lti.what to do')}</h2>",
            f"<ol><li>{self._say('lti.go', pseudonym=member.pseudonym)}</li>"
            f"<li>{self._play(launch.terms)}</li><li>{self._say('lti.return')}</li></ol>",
            f"<h2>{self._say('lti.scores')}</h2>",
            f"<p>{self._grade(launch, member)}</p>",
            self._trials(member.trials),
            f"<h2>{self._say('lti.data')}</h2>",
            f'<p class="soft">{self._say("lti.data text", platform=launch.platform.name)}</p>',
        ]
        return self._page("".join(parts))

    def for_teacher(self, launch: PlatformLaunch) -> str:
        """Return the page of a user who is no learner in the course and gets no pseudonym."""
        counts = self._say("lti.link works") if launch.line_item else self._say("lti.no grade")
        return self._page(
            f"<p>{self._say('lti.no learner')}</p><p>{counts}</p>"
            f"<h2>{self._say('lti.what to do')}</h2><p>{self._play(launch.terms)}</p>"
        )

    def refusal(self, reason: str) -> str:
        """Return a page that says that a launch has failed; the reason is for the operator."""
        return self._page(
            f"<h2>{self._say('lti.refused')}</h2><p>{self._say('lti.refused help')}</p>"
            f'<code lang="en">{html.escape(reason)}</code>'
        )

    def _play(self, terms: GradeTerms) -> str:
        task = self._task(terms.task) if terms.task else self._say("lti.any task")
        mode = self._say(f"study.{terms.mode}") if terms.mode else self._say("lti.any mode")
        return self._say("lti.play", task=task, mode=mode)

    def _grade(self, launch: PlatformLaunch, member: CourseMember) -> str:
        if not launch.line_item:
            return self._say("lti.no grade")
        if member.grade is None:
            return self._say("lti.no grade yet")
        rule = "best" if launch.terms.rule is GradeRule.BEST else "latest"
        return self._say(f"lti.grade {rule}", score=member.grade)

    def _trials(self, trials: tuple[TrialRow, ...]) -> str:
        if not trials:
            return f"<p>{self._say('lti.no trials')}</p>"
        return f"<ul>{''.join(map(self._trial, reversed(trials[-MOST_TRIALS:])))}</ul>"

    def _trial(self, trial: TrialRow) -> str:
        mode = self._texts.say(f"mode.{trial.mode}") if trial.mode in MODES else trial.mode
        score = "result.of 100" if trial.acceptable else "result.unacceptable score"
        values = (
            self._value("result.score", score, score=trial.values.get("score")),
            self._value("result.fre", "result.mm", error=trial.values.get("rmse_mm")),
            self._value("result.true tre", "result.mm", error=trial.values.get("true_tre_mm")),
            self._value(
                "result.time", "lti.seconds", seconds=trial.values.get("completion_time_s")
            ),
        )
        started = trial.started_utc[:16].replace("T", " ")
        return (
            f'<li class="trial"><p><b>{html.escape(f"{self._task(trial.task)}, {mode}")}</b>'
            f'<span class="soft">{html.escape(started)} UTC</span></p>'
            f"<dl>{''.join(values)}</dl></li>"
        )

    def _value(self, name: str, text: str, **value: float | None) -> str:
        """Return a measured value, or nothing if it is unknown."""
        if None in value.values():
            return ""
        return f"<div><dt>{self._say(name)}</dt><dd>{self._say(text, **value)}</dd></div>"

    def _task(self, task: str) -> str:
        key = f"task.{task}"
        return self._texts.say(key) if key in self._texts else task_title(task)

    def _say(self, key: str, **values: object) -> str:
        return html.escape(with_units(self._texts.say(key, **values)))

    def _page(self, content: str) -> str:
        return (
            f'<!doctype html><html lang="{self._language}"><meta charset="utf-8">'
            '<meta name="viewport" content="width=device-width, initial-scale=1">'
            '<title>RASTrainer</title><link rel="icon" href="data:,">'
            f"<style>{STYLE}</style><main><h1>RASTrainer</h1>{content}</main></html>"
        )
