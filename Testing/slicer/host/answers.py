"""The user's answers to dialogs; the test prepares them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from Testing.slicer.host.failures import FAILURES


@dataclass(frozen=True)
class Message:
    """A message box that was shown."""

    title: str
    text: str
    details: str
    answer: str


class Answers:
    """Answers dialogs in the order in which the test has given the answers."""

    def __init__(self) -> None:
        self.messages: list[Message] = []
        self.are_given_by_hand = False
        self._prepared: list[tuple[str, Any]] = []

    def clear(self) -> None:
        self.__init__()

    def prepare(self, part: str, answer: Any) -> None:
        """Answer the next dialog whose text or title contains `part`."""
        self._prepared.append((part, answer))

    def take(self, *texts: str) -> Any | None:
        """Return the answer prepared for a dialog with these texts; None if there is none."""
        for prepared in self._prepared:
            if any(prepared[0] in text for text in texts):
                self._prepared.remove(prepared)
                return prepared[1]
        return None

    def show(self, title: str, text: str, details: str, buttons: list[str]) -> str:
        """Show a message box; return the name of the button that the user presses."""
        answer = self.take(title, text)
        if answer is None and len(buttons) > 1:
            FAILURES.add(f"No answer was prepared for this question: {text}")
            answer = next(name for name in ("Cancel", "No", buttons[-1]) if name in buttons)
        answer = answer or buttons[0]
        if answer not in buttons:
            FAILURES.add(f"“{text}” has no button {answer}; it has {', '.join(buttons)}.")
            answer = buttons[-1]
        self.messages.append(Message(title.strip(), text, details, answer))
        return answer

    def path(self, caption: str) -> str:
        """Return the path chosen in a file dialog; an empty one if it is canceled."""
        answer = self.take(caption)
        if answer is None:
            FAILURES.add(f"No file was prepared for the dialog “{caption}”.")
        return str(answer or "")


ANSWERS = Answers()
