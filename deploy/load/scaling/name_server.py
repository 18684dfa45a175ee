"""A small name server, in a cluster's place: the proxy asks it which replicas there are."""

import socket
import struct
import threading
from collections.abc import Iterable

A, IN = 1, 1
ANSWERS = 0x8580  # a response, authoritative, recursion as desired and available, no error
UNKNOWN = 0x8583  # the same, but there is no such name
TTL_S = 0  # nobody keeps what may change at any moment; the proxy has its own time
HEADER_BYTES = 12
MAX_QUESTION = 512


def answer(question: bytes, addresses_of: dict[str, tuple[str, ...]]) -> bytes:
    """The reply to one datagram: every address of the name, if IPv4 addresses were asked for. Raises ValueError if it is no question.

    Source: RFC 1035, section 4.
    """
    if len(question) < HEADER_BYTES:
        raise ValueError("too short")
    number, flags, questions = struct.unpack_from(">HHH", question)
    if flags & 0x8000 or questions != 1:
        raise ValueError("not one question")
    labels, place = [], HEADER_BYTES
    while place < len(question) and (length := question[place]):
        labels.append(question[place + 1 : place + 1 + length].decode("ascii", "replace").lower())
        place += 1 + length
    place += 1
    if len(question) < place + 4:
        raise ValueError("cut off")
    kind, family = struct.unpack_from(">HH", question, place)
    asked, name = question[HEADER_BYTES : place + 4], ".".join(labels)
    known = addresses_of.get(name)
    addresses = known if known and (kind, family) == (A, IN) else ()
    records = b"".join(struct.pack(">HHHIH", 0xC00C, A, IN, TTL_S, 4) + socket.inet_aton(address) for address in addresses)
    return struct.pack(">HHHHHH", number, UNKNOWN if known is None else ANSWERS, 1, len(addresses), 0, 0) + asked + records


class NameServer:
    """Answers in a thread of its own until it is closed."""

    def __init__(self, host: str = "127.0.0.1") -> None:
        self._addresses: dict[str, tuple[str, ...]] = {}
        self._socket = socket.socket(type=socket.SOCK_DGRAM)
        self._socket.bind((host, 0))
        self.address = f"{host}:{self._socket.getsockname()[1]}"
        self._thread = threading.Thread(target=self._serve, name="name server", daemon=True)
        self._thread.start()

    def notify(self, name: str, addresses: Iterable[str]) -> None:
        """From now on the name has these addresses."""
        self._addresses = self._addresses | {name: tuple(addresses)}

    def close(self) -> None:
        self._socket.close()

    def _serve(self) -> None:
        while True:
            try:
                question, sender = self._socket.recvfrom(MAX_QUESTION)
            except OSError:  # closed
                return
            try:
                self._socket.sendto(answer(question, self._addresses), sender)
            except (ValueError, OSError):
                continue
