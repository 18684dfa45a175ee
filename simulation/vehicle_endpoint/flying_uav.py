"""One simulated UAV on its socket: flight model, MAVLink endpoint, signing and link faults."""

import time
from dataclasses import dataclass, field
from typing import Any

from mavlink.frames import message_of
from simulation.flight.faults import Faults, Weather
from simulation.flight.uav import SimulatedUav
from simulation.vehicle_endpoint.radio import Radio
from simulation.vehicle_protocol.endpoint import Endpoint
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from simulation.vehicle_protocol.signed_link import SignedLink
from simulation.vehicle_protocol.streams import Outgoing, Station


@dataclass
class FlyingUav:
    """A UAV stepped by the owner of the clock. `key` is 32 bytes, or None for a UAV that neither signs nor checks."""

    uav: SimulatedUav
    system: int
    radio: Radio
    autopilot_type: SimulatedAutopilot = SimulatedAutopilot.PX4
    key: bytes | None = field(default=None, repr=False)
    sent: int = 0
    received_count: int = 0
    refused: int = 0
    endpoint: Endpoint = field(init=False)
    _signed: SignedLink = field(init=False, repr=False)

    def __post_init__(self) -> None:
        self.endpoint = Endpoint(
            self.uav, autopilot_type=self.autopilot_type, system=self.system, unix_at_zero_s=time.time() - time.monotonic()
        )
        self._signed = SignedLink(self.system, self.key, self.uav.faults.clock_offset_s)

    def step(self) -> None:
        """Advance one step of the flight, and send what is due."""
        self.uav.step()
        unix_s, now_s = time.time(), time.monotonic()
        self.endpoint.unix_at_zero_s = unix_s + self._signed.clock_offset_s - now_s
        self._send(self.endpoint.tick(now_s), unix_s)

    def receive_frames(self) -> None:
        """Process all received frames, and send the answers."""
        is_lost = self._is_link_lost
        for frame, address in self.radio.received():
            unix_s = time.time()
            if is_lost:
                continue
            if not self._signed.is_believed(frame, unix_s):
                self.refused += 1
                continue
            message: Any = message_of(frame)
            link = self.radio.link_of(address)
            if message is None or link is None:
                continue
            self.received_count += 1
            self._send(self.endpoint.receive(message, Station(frame.system, frame.component, link), time.monotonic()), unix_s)

    def change(self, *, weather: Weather | None = None, faults: Faults | None = None) -> None:
        """Change weather and faults in flight."""
        if weather is not None:
            self.uav.weather = weather
        if faults is not None:
            if faults.clock_offset_s != self.uav.faults.clock_offset_s:
                self._signed.clock_offset_s = faults.clock_offset_s
            self.uav.faults = faults

    @property
    def _is_link_lost(self) -> bool:
        return self.uav.faults.is_link_lost(self.uav.now_s)

    def _send(self, outgoing: list[Outgoing], unix_s: float) -> None:
        if self._is_link_lost:
            return
        for one in outgoing:
            self.radio.send(self._signed.frame_of(one.message, unix_s, one.component), None if one.to is None else one.to.link)
            self.sent += 1
