"""How much a link carries: frames and bytes a second."""

from dataclasses import dataclass

WINDOW_S = 10.0


@dataclass(frozen=True, slots=True)
class Rate:
    """None before a whole window was seen."""

    bytes_s: float | None = None
    messages_s: float | None = None


@dataclass
class LinkRate:
    """Of what was received in the last whole window. Times are seconds since 1970."""

    _begin_s: float | None = None
    _bytes: int = 0
    _messages: int = 0
    _last: Rate = Rate()

    def count(self, size_bytes: int, now_s: float) -> None:
        self.at(now_s)
        self._bytes += size_bytes
        self._messages += 1

    def at(self, now_s: float) -> Rate:
        if self._begin_s is None or now_s < self._begin_s:
            self._begin_s, self._bytes, self._messages = now_s, 0, 0
        passed_s = now_s - self._begin_s
        if passed_s >= WINDOW_S:
            self._last = Rate(self._bytes / passed_s, self._messages / passed_s)
            self._begin_s, self._bytes, self._messages = now_s, 0, 0
        return self._last
