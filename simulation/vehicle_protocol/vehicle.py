"""The interface of a UAV for the MAVLink side, implemented by SimulatedUav."""

from collections.abc import Iterable, Sequence
from typing import Protocol

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionItem
from planning.views.camera import Camera
from simulation.flight.airframe import Settings
from simulation.flight.events import Event
from simulation.flight.states import FlightMode, Outcome, RallyPoint, SimulatedState


class Vehicle(Protocol):
    """Orders are accepted or refused at once; `state` and the events show their effect. Items count from 0 without home."""

    settings: Settings
    items: tuple[MissionItem, ...]
    rally_points: tuple[RallyPoint, ...]
    camera: Camera

    @property
    def state(self) -> SimulatedState: ...

    def take_events(self) -> Iterable[Event]: ...

    def load(self, items: Sequence[MissionItem]) -> Outcome: ...

    def arm(self) -> Outcome: ...

    def disarm(self, *, force: bool = False) -> Outcome: ...

    def take_off(self, height_relative_m: float) -> Outcome: ...

    def set_mode(self, mode: FlightMode) -> Outcome: ...

    def go_to(self, position: LonLat, altitude_relative_m: float, heading_deg: float | None = None) -> Outcome: ...

    def change_speed(self, speed_mps: float) -> Outcome: ...

    def set_current(self, index: int) -> Outcome: ...

    def operate(self, item: MissionItem) -> Outcome: ...
