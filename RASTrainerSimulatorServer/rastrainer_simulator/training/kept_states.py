"""The states of a trial to which it can go back where what came after could not be written."""

from __future__ import annotations

from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.training.feed import Feed


class KeptStates:
    """Every state of the present trial by its revision, and the feed at which it was left."""

    def __init__(self) -> None:
        self._states: dict[int, TrainingState] = {}
        self._feeds: dict[int, Feed] = {}

    def begin(self, *states: TrainingState) -> None:
        """Forget all states but these."""
        self._states = {state.revision: state for state in states}
        self._feeds = {}

    def keep(self, state: TrainingState) -> None:
        """Keep a state that the trial takes on."""
        self._states[state.revision] = state

    def leave(self, revision: int, feed: Feed) -> None:
        """Keep the feed at which the state of a revision is left."""
        self._feeds[revision] = feed

    def find(self, revision: int) -> tuple[TrainingState, Feed | None] | None:
        """Return the state of a revision and the feed at which it was left, None if it is present.

        None instead of both if there is no such state.
        """
        state = self._states.get(revision)
        return None if state is None else (state, self._feeds.get(revision))
