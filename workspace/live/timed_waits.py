"""Waiting in the event loop for an event with a timeout."""

import asyncio


async def wait_for_event(event: asyncio.Event, timeout_s: float) -> bool:
    """Return whether the event was set in time.

    `asyncio.wait_for` of Python 3.11 drops a cancellation that arrives together with the event (python/cpython issue 86296, fixed in
    3.12): a task with a loop around it then never ends.
    """
    try:
        async with asyncio.timeout(timeout_s):
            await event.wait()
    except TimeoutError:
        return False
    return True
