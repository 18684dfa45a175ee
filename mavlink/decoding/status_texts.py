"""STATUSTEXT: long texts come in pieces."""

from dataclasses import dataclass, field

from mavlink.frames import Message

PIECE = 50  # characters of a whole piece; a shorter one is the last
PATIENCE_S = 3.0
MOST_OPEN = 8
LONGEST = 500


@dataclass(frozen=True)
class StatusText:
    """severity: MAV_SEVERITY, 0 emergency to 7 debug."""

    severity: int
    text: str
    received_s: float


@dataclass
class _Open:
    severity: int
    received_s: float
    pieces: dict[int, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        ends = range(max(self.pieces) + 1)
        return "".join(self.pieces.get(number, "…") for number in ends)


@dataclass
class TextCollector:
    """Texts of one vehicle. What lacks a piece is given out with a gap when its time is over."""

    _open: dict[tuple[int, int], _Open] = field(default_factory=dict)

    def receive(self, message: Message, now_s: float) -> list[StatusText]:
        text = _clean(message.text)
        number = getattr(message, "id", 0)
        if number == 0:
            return [StatusText(message.severity, text, now_s)] if text else []
        key = (message.get_srcComponent(), number)
        collected = self._open.setdefault(key, _Open(message.severity, now_s))
        collected.pieces[message.chunk_seq] = text
        last = next((place for place, piece in collected.pieces.items() if len(piece) < PIECE), None)
        if last is not None and all(place in collected.pieces for place in range(last)):
            return [_closed(self._open.pop(key))]
        return self._overdue(now_s, most=MOST_OPEN)

    def tick(self, now_s: float) -> list[StatusText]:
        return self._overdue(now_s, most=MOST_OPEN)

    def _overdue(self, now_s: float, *, most: int) -> list[StatusText]:
        over = [key for key, collected in self._open.items() if now_s - collected.received_s > PATIENCE_S]
        over += [key for key in self._open if key not in over][: max(len(self._open) - len(over) - most, 0)]
        return [_closed(self._open.pop(key)) for key in over]


def _closed(collected: _Open) -> StatusText:
    return StatusText(collected.severity, collected.text[:LONGEST], collected.received_s)


def _clean(text: str | bytes) -> str:
    words = text.decode(errors="replace") if isinstance(text, bytes) else text
    return "".join(letter if letter.isprintable() else " " for letter in words.rstrip("\0"))
