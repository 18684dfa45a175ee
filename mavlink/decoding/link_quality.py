"""How much of what a vehicle sends arrives, by the numbers of its frames; or how strong its radio is, where that tells."""

from dataclasses import dataclass, field

from mavlink.frames import Message

KEPT_FRAMES = 200.0  # over which the mean runs
LARGEST_GAP = 128  # of numbers that wrap at 256; more is a repetition, another order, or a new start
RADIO_FULL = 254
RADIO_UNKNOWN = 255
RADIO_KEPT_S = 10.0


@dataclass
class LinkQuality:
    """Of one vehicle."""

    _last: dict[int, int] = field(default_factory=dict)  # by component
    _received: float = 0.0
    _sent: float = 0.0
    _radio_percent: float | None = None
    _radio_at_s: float = 0.0

    def count(self, component: int, sequence: int) -> None:
        before = self._last.get(component)
        step = 1 if before is None else (sequence - before) % 256
        if not 1 <= step <= LARGEST_GAP:
            return
        self._last[component] = sequence
        kept = (1.0 - 1.0 / KEPT_FRAMES) ** step
        self._received = self._received * kept + 1.0
        self._sent = self._sent * kept + step

    def receive_radio(self, message: Message, now_s: float) -> None:
        """RADIO_STATUS: the weaker end counts."""
        ends = [rssi for rssi in (message.rssi, message.remrssi) if rssi != RADIO_UNKNOWN]
        if ends:
            self._radio_percent, self._radio_at_s = 100.0 * min(*ends, RADIO_FULL) / RADIO_FULL, now_s

    def percent(self, now_s: float) -> float | None:
        if self._radio_percent is not None and now_s - self._radio_at_s <= RADIO_KEPT_S:
            return self._radio_percent
        return round(min(100.0 * self._received / self._sent, 100.0), 1) if self._sent else None
