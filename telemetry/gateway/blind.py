"""A command sent to a vehicle of which nothing is heard, until it is heard again or nobody wants the command any more."""

import asyncio
import time
from collections.abc import Awaitable, Callable

from mavlink.addressing import Ends
from mavlink.commands.actions import Order
from mavlink.commands.unacknowledged import blind_message, pause_s
from telemetry.gateway.session import Session

LOOK_EVERY_S = 0.25


async def send_blind(order: Order, session: Session, may_send: Callable[[], bool], is_wanted: Callable[[], Awaitable[bool]]) -> None:
    """`may_send` is asked before each message, `is_wanted` after it."""
    sent, next_s = 0, time.monotonic()
    while may_send() and session.state.flavour is not None:
        if (now_s := time.monotonic()) >= next_s:
            session.commanded_s = now_s
            session.send([blind_message(order, session.state.flavour, Ends(session.uav.system), sent)])
            sent += 1
            next_s = now_s + pause_s(sent)
            if not await is_wanted():
                return
        await asyncio.sleep(LOOK_EVERY_S)
