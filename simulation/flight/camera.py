"""Photos on request, at time intervals or at distances."""

from simulation.flight.orders import TakePhotos


class Camera:
    """The camera; `number` counts the photos since the start."""

    def __init__(self) -> None:
        self.number = 0
        self._order: TakePhotos | None = None
        self._left = 0
        self._due_s = 0.0
        self._due_m = 0.0

    def start(self, order: TakePhotos, now_s: float, flown_m: float) -> None:
        self._order, self._left = order, order.count
        self._due_s, self._due_m = now_s, flown_m + order.distance_m

    def stop(self) -> None:
        self._order = None

    def is_due(self, now_s: float, flown_m: float) -> bool:
        """Return whether a photo is taken now, and count it."""
        order = self._order
        if order is None:
            return False
        if order.distance_m > 0.0:
            if flown_m < self._due_m:
                return False
            self._due_m += order.distance_m
        else:
            if now_s + 1e-6 < self._due_s:
                return False
            self._due_s += order.interval_s
            self._left -= 1
            if self._left == 0 or (order.interval_s <= 0.0 and order.count == 0):
                self._order = None
            elif order.interval_s <= 0.0:
                self._due_s = now_s
        self.number += 1
        return True
