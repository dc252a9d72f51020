"""The preference to begin tests with the trial run; other tests cover the tutorial."""

from __future__ import annotations

import json
from pathlib import Path

from rastrainer.protocol import TutorialRule
from rastrainer_simulator.flow.session.preferences import PREFERENCES_FILE

WITHOUT_TUTORIAL = {"tutorial": TutorialRule.SKIPPED.value}


def skip_tutorial(config: Path) -> None:
    """Have a settings folder skip the tutorial, unless its preferences mention it."""
    config.mkdir(parents=True, exist_ok=True)
    path = config / PREFERENCES_FILE
    preferences = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    path.write_text(json.dumps({**WITHOUT_TUTORIAL, **preferences}), encoding="utf-8")
