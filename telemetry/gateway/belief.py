"""Which frames are believed to be a UAV's: signed with its key, or, where that is allowed, from the sender that had its system id first."""

from dataclasses import dataclass, field
from typing import Any

from missions.mavlink.frames import Frame
from missions.mavlink.signing import Refusal, SignatureCheck
from telemetry.gateway.fleet import KnownUav
from telemetry.gateway.peers import Peer

SENDER_SILENT_S = 5.0  # after which another sender may have the system id, where nothing is signed
SECOND_SENDER = "second-sender"


@dataclass
class Belief:
    """Times are seconds since 1970. `peer` is who was believed last, at `heard_s`."""

    uav: KnownUav
    peer: Peer | None = None
    heard_s: float = 0.0
    second_sender: tuple[str, float] | None = None  # who, and when last
    has_signed: bool = False  # since somebody asked last
    _check: SignatureCheck | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        self._check = SignatureCheck(self.uav.key) if self.uav.key else None

    def refusal(self, frame: Frame, peer: Peer, now_s: float) -> str | None:
        """None: it is believed."""
        refused = self._refusal(frame, peer, now_s)
        if refused is None:
            self.peer, self.heard_s = peer, now_s
        return refused

    def could_be(self, frame: Frame, now_s: float) -> bool:
        """Of a frame that waits to be received: whether it is worth keeping."""
        if self.uav.key is not None and frame.is_signed:
            return SignatureCheck(self.uav.key).refusal(frame, now_s) in (None, Refusal.TOO_OLD)
        return self.uav.allows_unsigned

    def change(self, uav: KnownUav) -> None:
        """The UAV's row or key was changed. Who was believed by another key is not believed, nor answered, any more."""
        if uav.credential_id != self.uav.credential_id:
            self._check = SignatureCheck(uav.key) if uav.key else None
            self.peer = None
        elif self.uav.allows_unsigned and not uav.allows_unsigned:
            self.peer = None
        self.uav = uav

    def take_up(self, received: dict[str, int]) -> None:
        """The newest timestamps of streams, as `received` was when another gateway served it."""
        if self._check is not None:
            self._check.last = dict(received)

    @property
    def received(self) -> dict[str, Any] | None:
        return None if self._check is None else dict(self._check.last)

    @property
    def _has_shown_its_key(self) -> bool:
        """To this gateway or one before it: who speaks without it now is somebody else, though unsigned frames be allowed."""
        return self._check is not None and bool(self._check.last)

    def _refusal(self, frame: Frame, peer: Peer, now_s: float) -> str | None:
        if self._check is not None and frame.is_signed:
            refusal = self._check.refusal(frame, now_s)
            self.has_signed |= refusal is None
            return refusal
        if not self.uav.allows_unsigned or self._has_shown_its_key:
            return Refusal.NO_KEY if frame.is_signed else Refusal.UNSIGNED
        if self.peer is None or peer == self.peer or not is_within(self.heard_s, now_s, SENDER_SILENT_S):
            return None
        self.second_sender = (peer.name, now_s)
        return SECOND_SENDER


def is_within(at_s: float, now_s: float, span_s: float) -> bool:
    """Also where our clock of the day was set back since: what seems to lie ahead is no reason to wait for it."""
    return abs(now_s - at_s) < span_s
