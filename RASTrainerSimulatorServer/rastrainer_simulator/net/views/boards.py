"""Teachers' boards at this seat: their news, and orders given with its PIN.

A board sees the trainee, their progress and warnings; it may pause, send a sentence, or show a
replay.
"""

from __future__ import annotations

import asyncio
import math

from aiohttp import web
from aiohttp.typedefs import Handler

from rastrainer.errors import InputError
from rastrainer.number_text import with_units
from rastrainer.protocol import OPEN_PHASES
from rastrainer_simulator.net.views.access_control import ROLE, fresh_json, read_body, refuse_for
from rastrainer_simulator.ops.instructor_pin import InstructorPin
from rastrainer_simulator.presentation.messages import (
    OrderRequest,
    Seat,
    SeatNews,
    ViewRole,
    message_text,
)
from rastrainer_simulator.presentation.presenter import Presenter
from rastrainer_simulator.state import SimulationState

ONLY_BOARDS = "Only a teacher's board may instruct: pair as one."
NO_PIN = "This seat takes no orders: set a PIN there with rastrainer instructor-pin."
WRONG_PIN = "This is not the PIN of this seat."
TOO_MANY = "There were too many wrong PINs: wait."


def seat_text(now: SimulationState, seat: Seat) -> str:
    """Return what a board receives of a seat, with the trial's clock in whole seconds."""
    training = now.training
    is_open = training.phase in OPEN_PHASES
    news = SeatNews(
        **vars(seat),
        phase=training.phase,
        touched=len(training.touches) if is_open else 0,
        rejected=training.rejected if is_open else 0,
        elapsed_s=math.floor(now.completion_time) if is_open else 0,
        touch=now.touch,
    )
    return with_units(message_text(news))


def instructor_orders(pin: InstructorPin | None, presenter: Presenter) -> Handler:
    """Return what takes orders over HTTP, each `{"pin", "order", "text"}` with the seat's PIN.

    It answers 200, or why not in one sentence.
    """
    one_guess = asyncio.Lock()

    async def take(request: web.Request) -> web.Response:
        if request[ROLE] is not ViewRole.BOARD:
            raise web.HTTPForbidden(text=ONLY_BOARDS)
        asked = await read_body(request, OrderRequest)
        if pin is None or not pin.is_set:
            raise web.HTTPConflict(text=NO_PIN)
        # One after the other: many guesses at the same time would take all threads.
        async with one_guess:
            try:
                answer = await asyncio.to_thread(pin.guess, asked.pin)
            except InputError as error:
                raise web.HTTPConflict(text=str(error)) from None
        refuse_for(answer.wait_s, TOO_MANY)
        if not answer.is_right:
            raise web.HTTPForbidden(text=WRONG_PIN)
        problem = presenter.instruct(asked.order, asked.sentence)
        if problem:
            raise web.HTTPConflict(text=problem)
        return fresh_json({})

    return take
