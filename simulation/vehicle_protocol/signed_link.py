"""Signing of a vehicle with a key: authentication of received frames, and its own signatures."""

from dataclasses import dataclass, field

from mavlink.frames import Frame, Message
from mavlink.signing import EPOCH_UNIX_S, UNITS_PER_S, FrameRefusal, FrameWriter, SignatureCheck
from simulation.vehicle_protocol.streams import AUTOPILOT


@dataclass
class SignedLink:
    """Signs and checks the frames of one vehicle; without a key nothing is signed and everything is accepted.

    `clock_offset_s` is the error of the vehicle's clock. A slow clock is set by the first valid signature, as the MAVLink guide requires. A
    fast one stays wrong, and others refuse its frames.
    """

    system: int
    key: bytes | None = field(default=None, repr=False)
    clock_offset_s: float = 0.0
    _writers: dict[int, FrameWriter] = field(default_factory=dict, repr=False)  # by component
    _checks: dict[int, SignatureCheck] = field(default_factory=dict, repr=False)

    def is_believed(self, frame: Frame, unix_s: float) -> bool:
        """Return whether a frame is accepted. unix_s: the true time."""
        if self.key is None:
            return True
        check = self._checks.setdefault(frame.system, SignatureCheck(self.key))
        refusal = check.refusal(frame, unix_s + self.clock_offset_s)
        if refusal is FrameRefusal.FROM_THE_FUTURE and frame.timestamp is not None:  # only returned for valid signatures
            self.clock_offset_s = EPOCH_UNIX_S + frame.timestamp / UNITS_PER_S - unix_s
            refusal = check.refusal(frame, unix_s + self.clock_offset_s)
        return refusal is None

    def frame_of(self, message: Message, unix_s: float, component: int = AUTOPILOT) -> bytes:
        writer = self._writers.setdefault(component, FrameWriter(self.system, component, key=self.key))
        return writer.frame_of(message, unix_s + self.clock_offset_s)
