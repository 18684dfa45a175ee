"""Data around a UAV: its link, onboard list, orders, zones and conflicts. Times are Unix seconds."""

from dataclasses import dataclass
from typing import Any
from uuid import UUID

from inspection.geodesy import LonLat
from mavlink.rtl import RtlBehaviour
from planning.clearance.lost_link import LostLinkPlan
from telemetry.alerting.consumption import Consumption
from telemetry.alerting.energy import EnergyPlan
from telemetry.alerting.route_line import RouteLine


@dataclass(frozen=True, slots=True)
class LinkFacts:
    """State of the UAV's link. `last_message_s` is the receipt of the last message, by the server's clock.

    `clock_rate`: the vehicle's seconds per server second; not 1 if it is simulated faster than real time. `battery_state`: as the vehicle
    reports it, a name of mavlink/vehicle_state.py; empty: not reported.
    """

    last_message_s: float | None = None
    mode: str = ""
    is_armed: bool | None = None
    is_in_air: bool | None = None
    clock_rate: float = 1.0
    battery_state: str = ""
    autopilot: str = ""  # a name of mavlink/autopilot_type.py
    rtl_behaviour: RtlBehaviour | None = None  # None: unknown


@dataclass(frozen=True, slots=True)
class IssuedOrder:
    """The latest flight command from here that did not fail. `done_s` is None while it is under way."""

    kind: str
    done_s: float | None
    given_s: float | None = None


@dataclass(frozen=True, slots=True)
class OnboardState:
    """The UAV's onboard list as read back. `is_approved`: it equals a flight of the approval in force.

    `is_changing`: a mission is being uploaded or cleared. `items` is the length of the list without home; None if unknown.
    """

    approval_id: UUID | None = None
    is_approved: bool = False
    doubt: str = ""
    is_changing: bool = False
    items: int | None = None
    first_item: int = 0


@dataclass(frozen=True, slots=True)
class FlightModel:
    """The approved flight with precomputed data. `max_airspeed_mps` is the UAV's highest airspeed.

    rally_points: where it may land by itself beside its home. consumption: to compute the flight home; None: an endurance is assumed.
    lost_link: the planned lost-link action; None: unknown.
    """

    line: RouteLine
    energy: EnergyPlan | None
    max_airspeed_mps: float
    reserve_percent: float
    rally_points: tuple[LonLat, ...] = ()
    consumption: Consumption | None = None
    lost_link: LostLinkPlan | None = None


@dataclass(frozen=True, slots=True)
class NearZone:
    """A zone whose bounding box a UAV may reach soon. `polygon` is a prepared shapely geometry in lon/lat; heights are above ground.

    `spans` are the times at which it applies, around now; None: always.
    """

    zone_id: int
    name: str
    polygon: Any
    floor_agl_m: float
    ceiling_agl_m: float
    spans: tuple[tuple[float, float], ...] | None = None

    def applies_at(self, moment_s: float) -> bool:
        return self.spans is None or any(start <= moment_s <= end for start, end in self.spans)

    def applies_between(self, from_s: float, to_s: float) -> bool:
        return self.spans is None or any(start <= to_s and from_s <= end for start, end in self.spans)

    def reaches(self, low_agl_m: float | None, high_agl_m: float | None) -> bool:
        """Return whether the zone overlaps a range of heights; an unknown height counts as inside."""
        return low_agl_m is None or high_agl_m is None or (self.floor_agl_m <= high_agl_m and low_agl_m <= self.ceiling_agl_m)


@dataclass(frozen=True, slots=True)
class Conflict:
    """Two UAVs that come near each other.

    `lateral_m` and `height_m` are the estimated distances at the closest point of approach. The `least_` values subtract the bounds and
    decide on the alert. The `now_` values are of this moment, within `bound_m` horizontally (95 %). closing_mps is positive while they
    converge. `yields_id` is the UAV to hold, `why` a reason of telemetry/alerting/conflicts.py.
    """

    other_id: int
    other_name: str
    in_s: float
    lateral_m: float
    height_m: float
    least_lateral_m: float
    least_height_m: float
    now_lateral_m: float
    now_height_m: float | None
    closing_mps: float
    bound_m: float
    yields_id: int
    yields_name: str
    why: str
