"""A finished plan in plain values: what each UAV flies, and what no route visits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from operation.reasons import Reason
from planning.energy.charging import ChargingStop
from planning.request import EndAction, PlanRequest
from planning.separation.separation import Separation
from planning.trajectory.heights import FloatArray
from planning.trajectory.timing import Timing
from planning.trajectory.waypoints import Waypoints

ALL_PLANS, WITHOUT_TIMED_ZONES = "all_plans", "without_timed_zones"  # of which plans bound and gap speak


@dataclass(frozen=True)
class PlannedRoute:
    """What one UAV flies; without targets it stays where it is."""

    targets: tuple[int, ...] = ()
    waypoints: Waypoints | None = None
    line: FloatArray | None = None
    length_m: float = 0.0
    duration_s: float = 0.0
    end_action: EndAction = EndAction.HOVER
    base: str | None = None  # where it lands
    is_flat: bool = False
    departs_s: float = 0.0  # after the plan's departure
    timing: Timing | None = None
    charging: tuple[ChargingStop, ...] = ()
    shortfall_wh: float = 0.0  # however it charges on the way
    blocked_by: tuple[int, ...] = ()  # spans of the network over which it would have to fly above the limit


@dataclass(frozen=True)
class Shortfall:
    """Either metres or Wh, and the seconds of level flight at the UAV's speed, in calm air of 1.225 kg/m3, that they are."""

    seconds: float
    metres: float | None = None
    wh: float | None = None


@dataclass(frozen=True)
class UnassignedTarget:
    """A target that no route visits; `target` is its place in the request.

    `reason` is one of the API's, `why` tells more: what keeps it from every route first, then what belongs to that. missing: metres or Wh
    without which no UAV can do it even alone, 0 where one could; None where that has no number. `shortfall` is what `why` tells. uavs:
    those that it speaks of, by their places in the request.
    """

    target: int
    reason: str
    why: tuple[Reason, ...]
    missing: float | None = None
    shortfall: Shortfall | None = None
    uavs: tuple[int, ...] = ()

    def is_for(self, code: str) -> bool:
        """Whether a reason with this code is among why."""
        return any(reason.code == code for reason in self.why)


@dataclass(frozen=True)
class PlanWarning:
    """What the operator should know of a plan; `uav` by its number in the request, None where it is about all. code: one of the API's."""

    code: str
    uav: int | None
    why: Reason


@dataclass(frozen=True, eq=False)
class Plan:
    """The answer to a request. routes: one for each UAV. untimed_flights: mission and UAV of flights of which nobody knows when they are
    where. lost_link and quality are in the shape of the API. solver_calls: how often the assignment was solved for it.
    """

    request: PlanRequest
    routes: Sequence[PlannedRoute]
    unassigned: Sequence[UnassignedTarget]
    warnings: Sequence[PlanWarning]
    separation: Separation
    untimed_flights: Sequence[tuple[str, str]]
    lost_link: Mapping[str, Any]
    quality: Mapping[str, Any]
    graph_version: int
    map_version: int
    has_terrain: bool
    solver_calls: int
