"""What a vehicle with a key believes, and how it signs."""

from dataclasses import dataclass, field

from mavlink.frames import Frame, Message
from mavlink.signing import EPOCH_UNIX_S, UNITS_PER_S, FrameWriter, Refusal, SignatureCheck
from simulation.vehicle_protocol.streams import AUTOPILOT


@dataclass
class SignedLink:
    """Frames in and out of one vehicle; without a key nothing is signed and everything believed.

    `clock_offset_s` is by how much the vehicle's clock is wrong. One that is slow is set by the first rightly signed frame, as the MAVLink
    guide has it; one that is fast stays so, and its frames are refused by others.
    """

    system: int
    key: bytes | None = field(default=None, repr=False)
    clock_offset_s: float = 0.0
    _writer: FrameWriter = field(init=False, repr=False)
    _checks: dict[int, SignatureCheck] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        self._writer = FrameWriter(self.system, AUTOPILOT, key=self.key)

    def is_believed(self, frame: Frame, unix_s: float) -> bool:
        """unix_s: the right time."""
        if self.key is None:
            return True
        check = self._checks.setdefault(frame.system, SignatureCheck(self.key))
        refusal = check.refusal(frame, unix_s + self.clock_offset_s)
        if refusal is Refusal.FROM_THE_FUTURE and frame.timestamp is not None:  # told only of right signatures
            self.clock_offset_s = EPOCH_UNIX_S + frame.timestamp / UNITS_PER_S - unix_s
            refusal = check.refusal(frame, unix_s + self.clock_offset_s)
        return refusal is None

    def frame_of(self, message: Message, unix_s: float) -> bytes:
        return self._writer.frame_of(message, unix_s + self.clock_offset_s)
