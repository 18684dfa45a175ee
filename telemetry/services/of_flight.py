"""What is worked out of an approved flight: once, as an approval never changes, and kept as long as somebody asks for it."""

import time
from collections.abc import Callable
from typing import Generic, TypeVar
from uuid import UUID

FORGOTTEN_AFTER_S = 600.0  # a watch asks every second

Found = TypeVar("Found")


class OfFlight(Generic[Found]):
    """Around a function of an approval's id, a UAV's id and a flight's number. One that is over is forgotten when another one begins."""

    def __init__(self, work_out: Callable[[UUID, int, int], Found], now_s: Callable[[], float] = time.monotonic) -> None:
        self._work_out, self._now_s = work_out, now_s
        self._kept: dict[tuple[UUID, int, int], tuple[Found, float]] = {}  # with when it was asked for last

    def __call__(self, approval_id: UUID, uav_id: int, flight: int) -> Found:
        key, now_s = (approval_id, uav_id, flight), self._now_s()
        known = self._kept.get(key)
        if known is None:
            known = self._work_out(approval_id, uav_id, flight), now_s
            self._kept = {other: kept for other, kept in self._kept.items() if now_s - kept[1] <= FORGOTTEN_AFTER_S}
        self._kept[key] = known[0], now_s
        return known[0]

    def __len__(self) -> int:
        return len(self._kept)
