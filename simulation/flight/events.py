"""Events of a flight in chronological order; times are simulated seconds since the start."""

from dataclasses import dataclass

from inspection.geodesy import LonLat
from operation.reasons import Reason
from simulation.flight.camera import LensPose
from simulation.flight.states import FlightMode, Severity


@dataclass(frozen=True, slots=True)
class ItemReached:
    """A mission item is done; `index` is its place in the loaded list."""

    at_s: float
    index: int


@dataclass(frozen=True, slots=True)
class MissionEnded:
    """The last item is done."""

    at_s: float


@dataclass(frozen=True, slots=True)
class ModeChanged:
    """`is_own`: changed by the UAV, not by an order."""

    at_s: float
    mode: FlightMode
    is_own: bool


@dataclass(frozen=True, slots=True)
class PhotoTaken:
    """Photo `number` since the start, counted from 1.

    `position` is the one that the UAV reports for it, `pose` the true one of the lens. `item` is the mission item that asked for it, in the
    loaded list, and `sequence` the number of that request; None without.
    """

    at_s: float
    number: int
    position: LonLat
    altitude_amsl_m: float
    item: int | None
    sequence: int | None
    pose: LensPose


@dataclass(frozen=True, slots=True)
class StatusTextSent:
    """A status text for the operator."""

    at_s: float
    text: Reason | str
    severity: Severity


@dataclass(frozen=True, slots=True)
class Armed:
    at_s: float


@dataclass(frozen=True, slots=True)
class Disarmed:
    at_s: float


@dataclass(frozen=True, slots=True)
class TookOff:
    at_s: float


@dataclass(frozen=True, slots=True)
class LandedAt:
    """The place of a landing."""

    at_s: float
    position: LonLat


@dataclass(frozen=True, slots=True)
class Crashed:
    at_s: float
    position: LonLat
    reason: Reason


Event = ItemReached | MissionEnded | ModeChanged | PhotoTaken | StatusTextSent | Armed | Disarmed | TookOff | LandedAt | Crashed
