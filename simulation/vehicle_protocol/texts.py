"""Words for the people at the stations."""

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import Message

PIECE = 50  # bytes of one STATUSTEXT
MOST_PIECES = 5


def text_messages(text: str, severity: int, number: int) -> list[Message]:
    """In pieces where it is long; `number` (1 to 65535) names what belongs together. Words are cut where they would go on for ever."""
    words = text.encode("ascii", "replace")[: PIECE * MOST_PIECES]
    pieces = [words[start : start + PIECE] for start in range(0, len(words), PIECE)] or [b""]
    identity = number if len(pieces) > 1 else 0
    if identity and len(pieces[-1]) == PIECE and len(pieces) < MOST_PIECES:
        pieces.append(b"")  # a full last piece would not tell that it is the last
    return [mavlink.MAVLink_statustext_message(severity, piece, identity, place) for place, piece in enumerate(pieces)]
