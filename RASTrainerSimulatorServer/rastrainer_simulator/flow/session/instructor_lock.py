"""What an instructor's PIN locks at a seat: the settings, the order, and passing on the control."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor

from rastrainer_simulator.ops.instructor_pin import PinAnswer, PinGuesses


class InstructorLock:
    """Locked wherever a PIN is set, until somebody enters it.

    It is locked again when the trainee changes, and when a trial or a tutorial begins: whoever
    trains then is not whom the instructor stood beside.
    """

    def __init__(self, pin: PinGuesses | None) -> None:
        """Lock by a PIN, which may be set and removed at any time; None locks nothing."""
        self._pin = pin
        self._is_open = False
        self._asked: Future[PinAnswer] | None = None
        self._seen = ("", "", False)

    @property
    def has_pin(self) -> bool:
        """Whether a PIN is set."""
        return self._pin is not None and self._pin.is_set

    @property
    def is_locked(self) -> bool:
        """Whether the PIN has to be entered first."""
        return self.has_pin and not self._is_open

    def guess(self, pin: str) -> None:
        """Have a PIN looked at, outside of this thread: that takes about 50 ms."""
        if self._pin is not None and self._asked is None:
            worker = ThreadPoolExecutor(1, "instructor-pin")
            self._asked = worker.submit(self._pin.guess, pin)
            worker.shutdown(wait=False)

    def take_answer(self) -> PinAnswer | None:
        """Return what became of the guess, once, and unlock by the right PIN; None before.

        Raises:
            InputError: the PIN's file cannot be read or is no PIN's.
        """
        if self._asked is None or not self._asked.done():
            return None
        asked, self._asked = self._asked, None
        answer = asked.result()
        self._is_open = answer.is_right
        return answer

    def forget_guess(self) -> None:
        """Unlock nothing by a PIN that is still being looked at."""
        self._asked = None

    def lock(self) -> None:
        """Lock again."""
        self._is_open = False

    def follow(self, trainee: str, trial_id: str, has_tutorial: bool) -> None:
        """Take note of who trains, of the trial, "" for none, and whether a tutorial is open."""
        before, self._seen = self._seen, (trainee, trial_id, has_tutorial)
        is_other_trial = trial_id not in ("", before[1])
        if trainee != before[0] or is_other_trial or (has_tutorial and not before[2]):
            self.lock()
