"""Waiting for an event: in time, too late, and cancelled at any moment."""

import asyncio

import pytest

from workspace.live.timed_waits import wait_for_event

LOOPS = 12  # steps of the event loop, more than waking takes


def test_an_event_in_time_and_one_too_late():
    async def scenario() -> tuple[bool, bool]:
        event = asyncio.Event()
        late = await wait_for_event(event, 0.001)
        asyncio.get_running_loop().call_soon(event.set)
        return late, await wait_for_event(event, 60.0)

    assert asyncio.run(scenario()) == (False, True)


@pytest.mark.parametrize("steps", range(LOOPS))
def test_a_cancellation_beside_the_event_ends_the_task(steps):
    """However many steps of the loop lie between the event and the cancellation."""

    async def scenario() -> bool:
        event = asyncio.Event()

        async def work() -> None:
            while True:
                await wait_for_event(event, 60.0)
                event.clear()

        task = asyncio.create_task(work())
        await asyncio.sleep(0.001)
        event.set()
        for _ in range(steps):
            await asyncio.sleep(0)
        task.cancel()
        await asyncio.wait([task], timeout=1.0)
        ended = task.done()
        while not task.done():  # or the loop of this test never ends
            task.cancel()
            await asyncio.sleep(0)
        return ended

    assert asyncio.run(scenario())
