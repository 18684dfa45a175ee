"""Data of approved flights for detectors and for the estimator, computed once: an approval never changes."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar
from uuid import UUID

from django.conf import settings

from inspection.geodesy import LonLat
from missions.models import Approval
from missions.services.commands.dispatch import ApprovedLoad, DamagedApproval, approved_load
from planning.clearance.lost_link import LostLink, LostLinkPlan
from planning.energy.conditions import conditions_from_json
from planning.energy.performance import performance_from_json
from planning.request import lost_link_from_json
from telemetry.alerting.consumption import Consumption
from telemetry.alerting.energy import energy_plan
from telemetry.alerting.route_line import RouteLine
from telemetry.alerting.surroundings import FlightModel
from telemetry.estimation.knowledge import Knowledge

HEIGHT_OF_WAY_M = 60.0  # height above ground of the wind used for the flight home
FORGOTTEN_AFTER_S = 600.0  # the estimator asks every second

Found = TypeVar("Found")


class OfFlight(Generic[Found]):
    """Caches a function of approval id, UAV id and flight number. Expired entries are dropped when a new one is added."""

    def __init__(self, work_out: Callable[[UUID, int, int], Found], now_s: Callable[[], float] = time.monotonic) -> None:
        self._work_out, self._now_s = work_out, now_s
        self._kept: dict[tuple[UUID, int, int], tuple[Found, float]] = {}  # with the time of the last use

    def __call__(self, approval_id: UUID, uav_id: int, flight: int) -> Found:
        key, now_s = (approval_id, uav_id, flight), self._now_s()
        known = self._kept.get(key)
        if known is None:
            known = self._work_out(approval_id, uav_id, flight), now_s
            self._kept = {other: kept for other, kept in self._kept.items() if now_s - kept[1] <= FORGOTTEN_AFTER_S}
        self._kept[key] = known[0], now_s
        return known[0]

    def __len__(self) -> int:
        return len(self._kept)


@dataclass(frozen=True, slots=True)
class ApprovedContent:
    """`items` is None for a UAV with a companion computer, which receives no fence either."""

    content_sha256: str
    items: int | None
    has_fence: bool = False


@OfFlight
def flight_model(approval_id: UUID, uav_id: int, flight: int) -> FlightModel | None:
    """Return the model of a flight; None after the last flight and for a damaged document."""
    found = _approved(approval_id, uav_id, flight)
    if found is None:
        return None
    approved, document = found
    route = approved.route
    figures = next(row["figures"] for row in document["routes"] if row["uav"] == uav_id)
    performance, of_flight = performance_from_json(figures["performance"]), route.flights[flight - 1]
    conditions = conditions_from_json(document["conditions"])
    plan = energy_plan(
        of_flight, cruise_speed_mps=route.cruise_speed_mps, performance=performance, conditions=conditions,
        rules=settings.FLIGHT_RULES, charging=route.charging_stops,
    )  # fmt: skip
    return FlightModel(
        line=RouteLine(of_flight, route.charging_stops),
        energy=plan,
        max_airspeed_mps=performance.max_airspeed_mps or route.cruise_speed_mps,
        reserve_percent=performance.reserve_percent,
        rally_points=tuple(
            LonLat(item.longitude_e7 / 1e7, item.latitude_e7 / 1e7) for item in (approved.load.rally if approved.load else ())
        ),
        lost_link=_lost_link(document),
        consumption=Consumption(route.cruise_speed_mps, performance, conditions.wind_at(HEIGHT_OF_WAY_M)),
    )


def _lost_link(document: Mapping[str, Any]) -> LostLinkPlan | None:
    if "lost_link" not in document:
        return None
    planned = lost_link_from_json(document["lost_link"])
    return LostLinkPlan(planned.behaviour, planned.rally_points, planned.hold_s)


@OfFlight
def knowledge_of(approval_id: UUID, uav_id: int, flight: int) -> Knowledge:
    """Return what the estimator knows of a flight; empty after the last flight and for a damaged document."""
    found = _approved(approval_id, uav_id, flight)
    if found is None:
        return Knowledge()
    approved, document = found
    figures = next(route["figures"] for route in document["routes"] if route["uav"] == uav_id)
    performance = performance_from_json(figures["performance"])
    return Knowledge(
        flight=approved.route.flights[flight - 1],
        cruise_speed_mps=approved.route.cruise_speed_mps,
        max_airspeed_mps=performance.max_airspeed_mps,
        climb_speed_mps=performance.climb_speed_mps or Knowledge.climb_speed_mps,
        conditions=conditions_from_json(document["conditions"]),
        home=approved.take_off.position,
        is_to_go_on=lost_link_from_json(document["lost_link"] or {}).behaviour is LostLink.GO_ON,
    )


@OfFlight
def approved_content(approval_id: UUID, uav_id: int, flight: int) -> ApprovedContent | None:
    found = _approved(approval_id, uav_id, flight)
    if found is None:
        return None
    approved, _document = found
    if approved.load is None:
        return ApprovedContent(approved.content_sha256, None)
    return ApprovedContent(approved.content_sha256, len(approved.load.mission), bool(approved.load.fence))


def _approved(approval_id: UUID, uav_id: int, flight: int) -> tuple[ApprovedLoad, dict[str, Any]] | None:
    approval = Approval.objects.filter(pk=approval_id).first()
    if approval is None:
        return None
    try:
        return approved_load(approval, uav_id=uav_id, flight=flight), approval.document
    except (DamagedApproval, LookupError, StopIteration):
        return None
