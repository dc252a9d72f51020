"""What a teacher may have done at a seat who knows its PIN: pause, say something, show a replay."""

from __future__ import annotations

import asyncio

from aiohttp import hdrs, web

from rastrainer.command_arguments import decode_json_object
from rastrainer.errors import InputError
from rastrainer.json_checks import accepted, one_of, text
from rastrainer_simulator.net.views.gate import ROLE, refuse_for
from rastrainer_simulator.net.views.presenter import InstructorOrder, Presenter
from rastrainer_simulator.net.views.sessions import ViewRole
from rastrainer_simulator.ops.instructor_pin import LONGEST_PIN, PinGuesses

LONGEST_SENTENCE = 200
BODY_S = 5.0
ONLY_BOARDS = "Only a teacher's board may instruct: pair as one."
NO_PIN = "This seat takes no orders: set a PIN there with rastrainer instructor-pin."
WRONG_PIN = "This is not the PIN of this seat."
TOO_MANY = "There were too many wrong PINs: wait."
_pin_text = text(LONGEST_PIN)
_order_name = one_of(*(order.value for order in InstructorOrder))


class InstructorOrders:
    """Takes orders over HTTP, each with the PIN."""

    def __init__(self, pin: PinGuesses | None, presenter: Presenter) -> None:
        """Take orders for a presenter; without a PIN none."""
        self._pin = pin
        self._presenter = presenter
        self._one_guess = asyncio.Lock()

    async def take(self, request: web.Request) -> web.Response:
        """Take `{"pin", "order", "text"}`; answer 200, or why not in one sentence."""
        if request[ROLE] is not ViewRole.BOARD:
            raise web.HTTPForbidden(text=ONLY_BOARDS)
        pin, order, sentence = await _order(request)
        # One after the other: many guesses at the same time would take all threads.
        async with self._one_guess:
            await self._check(pin)
        problem = self._presenter.instruct(order, sentence)
        if problem:
            raise web.HTTPConflict(text=problem)
        return web.json_response({}, headers={hdrs.CACHE_CONTROL: "no-store"})

    async def _check(self, pin: str) -> None:
        """Refuse a wrong PIN, and any while guessing is paused."""
        if self._pin is None or not self._pin.is_set:
            raise web.HTTPConflict(text=NO_PIN)
        try:
            answer = await asyncio.to_thread(self._pin.guess, pin)
        except InputError as error:
            raise web.HTTPConflict(text=str(error)) from None
        refuse_for(answer.wait_s, TOO_MANY)
        if not answer.is_right:
            raise web.HTTPForbidden(text=WRONG_PIN)


async def _order(request: web.Request) -> tuple[str, InstructorOrder, str]:
    try:
        body = await asyncio.wait_for(request.read(), BODY_S)
        values = decode_json_object(body.decode())
        pin = accepted(_pin_text, values.get("pin"), "pin")
        order = InstructorOrder(accepted(_order_name, values.get("order"), "order"))
        needs_text = order is InstructorOrder.SAY
        check = text(LONGEST_SENTENCE)
        sentence = accepted(check, values.get("text"), "text").strip() if needs_text else ""
        if needs_text and not sentence:
            raise InputError("text must say something.")
    except InputError as error:
        raise web.HTTPBadRequest(text=str(error)) from None
    except (ValueError, asyncio.TimeoutError, ConnectionError):
        raise web.HTTPBadRequest(text="Send JSON with pin, order and text.") from None
    return pin, order, sentence
