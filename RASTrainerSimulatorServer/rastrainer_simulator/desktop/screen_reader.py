"""Read what the trainee reads from the stream; what is not understood is left out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rastrainer_simulator.net.views.screen import (
    DepthRuler,
    ErrorArrow,
    Fact,
    Hint,
    ItemKind,
    Menu,
    MenuItem,
    ScoreTrend,
    Screen,
    ScreenMessage,
    Tone,
)
from rastrainer_simulator.vectors import vector

Json = Mapping[str, Any]


def screen_from_json(value: Json) -> Screen:
    """Return the screen of a `screen` message.

    Raises:
        ValueError, KeyError, TypeError: it is none.
    """
    menu = value["menu"]
    return Screen(
        menu=None if menu is None else _menu(menu),
        instruction=_message(value["instruction"]),
        warnings=tuple(_message(warning) for warning in value["warnings"]),
        status=tuple(str(fact) for fact in value["status"]),
        hints=tuple(
            Hint(str(hint["control"]), str(hint["action"]), str(hint["item"]))
            for hint in value["hints"]
        ),
        language=str(value["language"]),
        is_spoken=bool(value["is_spoken"]),
        has_sticks=bool(value["has_sticks"]),
        has_arrow=bool(value["has_arrow"]),
        errors=tuple(_error(arrow) for arrow in value["errors"]),
        is_head_clear=bool(value["is_head_clear"]),
        coverage=str(value["coverage"]),
        ruler=None if value["ruler"] is None else _ruler(value["ruler"]),
    )


def _ruler(value: Json) -> DepthRuler:
    outer, inner = value["outer"], value["inner"]
    return DepthRuler(
        float(value["entry"]),
        None if outer is None else float(outer),
        None if inner is None else float(inner),
        float(value["target"]),
    )


def _error(value: Json) -> ErrorArrow:
    return ErrorArrow(vector(value["begin"]), vector(value["end"]), Tone(value["tone"]))


def _menu(value: Json) -> Menu:
    return Menu(
        name=str(value["name"]),
        title=str(value["title"]),
        paragraphs=tuple(str(text) for text in value["paragraphs"]),
        facts=tuple(
            Fact(str(fact["label"]), str(fact["value"]), Tone(fact["tone"]))
            for fact in value["facts"]
        ),
        items=tuple(_item(item) for item in value["items"]),
        focus=str(value["focus"]),
        picture=str(value["picture"]),
        trend=None if value["trend"] is None else _trend(value["trend"]),
    )


def _trend(value: Json) -> ScoreTrend:
    return ScoreTrend(
        text=str(value["text"]),
        scores=tuple(min(max(float(score), 0.0), 100.0) for score in value["scores"]),
        mark=float(value["mark"]),
    )


def _item(value: Json) -> MenuItem:
    return MenuItem(
        name=str(value["name"]),
        label=str(value["label"]),
        kind=ItemKind(value["kind"]),
        value=str(value["value"]),
        is_enabled=bool(value["is_enabled"]),
        help=str(value["help"]),
        picture=str(value["picture"]),
    )


def _message(value: Json) -> ScreenMessage:
    return ScreenMessage(str(value["text"]), Tone(value["tone"]))
