"""Ending the gateway's loops."""

import asyncio

from telemetry.gateway.process import _cancel


def test_a_loop_that_drops_a_cancellation_is_cancelled_again():
    async def scenario() -> int:
        dropped = 0

        async def loop() -> None:
            nonlocal dropped
            while True:
                try:
                    await asyncio.Event().wait()
                except asyncio.CancelledError:
                    dropped += 1
                    if dropped > 1:
                        raise

        task = asyncio.create_task(loop())
        await asyncio.sleep(0)
        async with asyncio.timeout(30.0):
            await _cancel([task])
        return dropped

    assert asyncio.run(scenario()) == 2
