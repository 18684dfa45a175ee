"""What is around a UAV: its link, what it holds and was told, zones, and other UAVs. Times are Unix seconds."""

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
    """What is known of the UAV's link. `last_message_s` is when anything was last received, by the server's clock.

    `clock_rate`: the vehicle's seconds a second of the server's; not 1 where it is flown faster than real time.
    `battery_state`: as the vehicle itself has it, a name of mavlink/vehicle_state.py; empty: it does not tell.
    """

    last_message_s: float | None = None
    mode: str = ""
    is_armed: bool | None = None
    is_in_air: bool | None = None
    clock_rate: float = 1.0
    battery_state: str = ""
    autopilot: str = ""  # a name of mavlink/autopilot_type.py
    rtl_behaviour: RtlBehaviour | None = None  # how high it flies home by itself; None: not known


@dataclass(frozen=True, slots=True)
class IssuedOrder:
    """The latest command of ours about its flight that did not fail. `done_s` is None as long as it is on its way."""

    kind: str
    done_s: float | None
    given_s: float | None = None


@dataclass(frozen=True, slots=True)
class OnboardState:
    """What the UAV holds, as far as it was read back. `is_approved`: exactly a flight of the approval in force.

    `is_changing`: a mission is being brought to it or taken off it; `items` of the list, without home, None where it has none.
    """

    approval_id: UUID | None = None
    is_approved: bool = False
    doubt: str = ""
    is_changing: bool = False
    items: int | None = None
    first_item: int = 0


@dataclass(frozen=True, slots=True)
class FlightModel:
    """What was approved of the flight, worked out once. `max_airspeed_mps` is the highest that the UAV flies through the air.

    rally_points: where it may land by itself beside its home. consumption: what the way home takes; None: an endurance is assumed.
    lost_link: what was planned for a lost link; None: not known.
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
    """A zone whose box a UAV may touch soon. `polygon` is a prepared shapely geometry in lon/lat; heights are above ground.

    `spans` are the times at which it applies, about now; None: always.
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
        """Between two heights; one that is not known counts as reached."""
        return low_agl_m is None or high_agl_m is None or (self.floor_agl_m <= high_agl_m and low_agl_m <= self.ceiling_agl_m)


@dataclass(frozen=True, slots=True)
class Conflict:
    """Two UAVs that come near each other.

    Distances `lateral_m` and `height_m` are at the closest, with the places as estimated; `least_` at the worst of their bounds, by which
    an alert is raised; `now_` of this moment, as measured or estimated, within `bound_m` across the ground (95 of 100 times). closing_mps
    is above 0 while they come nearer. `yields_id` is the UAV that is best held, `why` a reason of telemetry/alerting/conflicts.py.
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
