"""Cache for data derived from an approved flight: computed once, as an approval never changes, and kept while it is used."""

import time
from collections.abc import Callable
from typing import Generic, TypeVar
from uuid import UUID

FORGOTTEN_AFTER_S = 600.0  # the estimator asks every second

Found = TypeVar("Found")


class OfFlight(Generic[Found]):
    """Caches a function of approval id, UAV id and flight number. Expired entries are dropped when a new one is added."""

    def __init__(self, work_out: Callable[[UUID, int, int], Found], now_s: Callable[[], float] = time.monotonic) -> None:
        self._work_out, self._now_s = work_out, now_s
        self._kept: dict[tuple[UUID, int, int], tuple[Found, float]] = {}  # with the time of the last use

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
