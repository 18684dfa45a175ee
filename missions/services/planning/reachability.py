"""Which assets the chosen UAVs can inspect from their positions or from chosen bases, and why not the others."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from django.conf import settings
from django.utils.translation import gettext as _

from inspection.selectors.planning import planning_read
from missions.selectors.planning_context import planning_context
from planning.airspace import Airspace, airspace_on, column_m, zone_at, zone_choice
from planning.assignment.refusals import groundings
from planning.energy.path_cost import FlightClass
from planning.problem import UavStart
from planning.reachability.reachability import FlownNetwork, PossibleFlight, reach
from planning.reachability.reachable_assets import Reach, Reachability
from planning.request import ROUTE_ENDS, BaseRequest, EndAction, PlanRequest, UavRequest
from workspace.locale_negotiation import number_text
from workspace.reason_texts import reason_text

Box = tuple[float, float, float, float]
CODES = {
    Reachability.PARTLY: "partly_reachable",
    Reachability.BEYOND_RANGE: "beyond_range",
    Reachability.BEYOND_ENERGY: "beyond_energy",
    Reachability.WIND: "wind",
    Reachability.CUT_OFF: "no_path",
    Reachability.ABOVE_HEIGHT_LIMIT: "above_height_limit",
    Reachability.INSIDE_ZONE: "inside_zone",
    Reachability.NO_LANDING: "inside_zone",
}
NO_UAV = "no_uav"


@dataclass(frozen=True)
class _Start:
    """A UAV of the request, and the base from which it starts; None for its own position."""

    uav: int
    base: str | None


def reachability(*, request: PlanRequest, starts: Sequence[BaseRequest] = (), box: Box | None = None) -> dict[str, Any]:
    """Return the reachability in the shape of the API; the request's targets are ignored. Raises NoGraph.

    starts: bases from each of which each UAV might fly, instead of its own position; box: west, south, east, north of the wanted area.
    As in a plan's first stage, all zones that can be in force during the flight are avoided, and the shortest paths count.
    """
    context = planning_context(request, planning_read().ground())
    airspace = airspace_on(context, zone_choice(context.zones, request.departs_at, context.rules.flight).widest, is_by_length=True)
    starting, flights, grounded = _flights(request, starts, airspace)
    bases = [base.position for base in request.bases if zone_at(base.position, airspace) is None]
    found = reach(
        FlownNetwork(
            context.network, airspace.whole_graph, airspace.graph, airspace.zones, airspace.leg_zones, _no_landing(airspace, flights)
        ),
        flights, bases, airspace.access, conditions=request.conditions, flight_rules=airspace.flight,
    )  # fmt: skip
    chosen = np.ones(len(found.asset), dtype=bool) if box is None else _in_box(found, box)
    may_charge = _may_charge(request, starting)
    code, reasons = _reasons(found, chosen, airspace.zones.names, has_flights=bool(flights), may_charge=may_charge)
    return {
        "reachable": int((code == 0).sum()),
        "of": len(code),
        "flights": [{"uav": start.uav, "base": start.base} for start in starting],
        "grounded": grounded,
        "reasons": reasons,
        "not_counted": ["charging"] if may_charge else [],
        "assets": {
            "ids": found.asset[chosen].tolist(),
            "code": code.tolist(),
            "flight": found.flight[chosen].tolist(),
            "missing_m": np.ceil(found.missing_m[chosen]).astype(np.int64).tolist(),
            "missing_wh": np.ceil(found.missing_wh[chosen]).astype(np.int64).tolist(),
        },
        "graph_version": airspace.graph.version,
        "ground_revision": context.map_version,
    }


def _flights(
    request: PlanRequest, starts: Sequence[BaseRequest], airspace: Airspace
) -> tuple[list[_Start], list[PossibleFlight], list[dict[str, Any]]]:
    """Return the flights that can take off, and the reasons of the others."""
    starting, flights, grounded = [], [], []
    for base in starts or (None,):
        uavs = request.uavs if base is None else [replace(uav, position=base.position) for uav in request.uavs]
        kept_down = groundings(uavs, airspace)
        for number, uav in enumerate(uavs):
            name = None if base is None else base.name
            if number in kept_down:
                why = kept_down[number]
                grounded.append({"uav": number, "base": name, "code": why.code, "message": reason_text(why.why)})
                continue
            action = request.end_action(number)
            limit_m = UavStart(uav.max_range_m, ROUTE_ENDS[action]).limit_m
            starting.append(_Start(number, name))
            flights.append(
                PossibleFlight(uav.position, ROUTE_ENDS[action], limit_m, action is not EndAction.HOVER, _class_of(uav, request))
            )
    return starting, flights, grounded


def _class_of(uav: UavRequest, request: PlanRequest) -> FlightClass | None:
    """Return the flight class; None for a UAV with an unknown battery in calm air."""
    if uav.performance.battery_wh is None and request.conditions.is_calm:
        return None
    return FlightClass(uav.performance, uav.cruise_speed_mps)


def _no_landing(airspace: Airspace, flights: Sequence[PossibleFlight]) -> np.ndarray | None:
    """Return the nodes over zones whose ceiling is below the flight; None where no flight lands at its target."""
    if not any(one.lands_there for one in flights):
        return None
    low = airspace.zones.where(np.isfinite(airspace.zones.ceiling_agl_m))  # the others are avoided altogether
    return low.contains(airspace.graph.position, airspace.access.zone_clearance_m, *column_m(0.0, airspace))


def _may_charge(request: PlanRequest, starting: Sequence[_Start]) -> bool:
    """Whether a flight may charge at towers, with a charger that supplies more than the UAV consumes on the ground."""
    uavs = [request.uavs[start.uav].performance for start in starting if request.may_charge(start.uav)]
    return any(uav.battery_wh is not None and (request.charging_w or 0.0) > uav.avionics_w for uav in uavs)


def _in_box(found: Reach, box: Box) -> np.ndarray:
    west, south, east, north = box
    in_lat = (found.box[:, 1] <= north) & (found.box[:, 3] >= south)
    if west > east:  # across the 180th meridian
        return in_lat & ((found.box[:, 2] >= west) | (found.box[:, 0] <= east))
    return in_lat & (found.box[:, 0] <= east) & (found.box[:, 2] >= west)


def _reasons(
    found: Reach, chosen: np.ndarray, zone_names: Sequence[str], *, has_flights: bool, may_charge: bool
) -> tuple[np.ndarray, list[dict[str, Any]]]:
    """Return a number for each asset, 0 for those that can be inspected, and the meaning of the others, from 1 on."""
    reachability, zone = found.state[chosen].astype(np.int64), found.zone[chosen].astype(np.int64)
    missing = found.missing_m[chosen] + found.missing_wh[chosen]  # only one of them is set
    kinds = len(Reachability)
    key = reachability + np.where(reachability == Reachability.INSIDE_ZONE, (zone + 1) * kinds, 0)
    keys, number, count = np.unique(key, return_inverse=True, return_counts=True)
    code_of, reasons = np.zeros(len(keys), dtype=np.int64), []
    for place, (one, assets) in enumerate(zip(keys.tolist(), count.tolist(), strict=True)):
        why = Reachability(one % kinds)
        if why is Reachability.REACHABLE:
            continue
        if why is Reachability.CUT_OFF and not has_flights:
            reasons.append({"code": NO_UAV, "message": _("No UAV can take off."), "count": assets})
        else:
            message = _message(why, one // kinds - 1, missing[number == place], zone_names, may_charge=may_charge)
            reasons.append({"code": CODES[why], "message": message, "count": assets})
        code_of[place] = len(reasons)
    return code_of[number], reasons


def _message(why: Reachability, zone: int, missing: np.ndarray, zone_names: Sequence[str], *, may_charge: bool) -> str:
    flight, access = settings.FLIGHT_RULES, settings.ROUTING_RULES
    if why is Reachability.PARTLY:
        return _("Some spans of the line or railway can be inspected, others cannot.")
    if why is Reachability.BEYOND_RANGE:
        words = _("The range of every UAV is too short: by %(least)s at the nearest, by %(most)s at the farthest.")
        return words % {"least": _km(float(missing.min())), "most": _km(float(missing.max()))}
    if why is Reachability.BEYOND_ENERGY:
        if may_charge:
            words = _("One battery gives %(least)s to %(most)s Wh too little: whether charging on the way suffices, a plan tells.")
        else:
            words = _("No battery suffices without charging: %(least)s Wh are missing at the nearest, %(most)s Wh at the farthest.")
        return words % {"least": number_text(np.ceil(missing.min())), "most": number_text(np.ceil(missing.max()))}
    if why is Reachability.WIND:
        return _("The wind is too strong on every way to it, or back.")
    if why is Reachability.CUT_OFF:
        words = _("No way that keeps clear of every zone was found: along the network, or up to %(km)s beside it.")
        return words % {"km": _km(access.access_leg_m)}
    if why is Reachability.ABOVE_HEIGHT_LIMIT:
        words = _("Too tall: it cannot be flown over with a clearance of %(clearance)s m below %(limit)s m.")
        return words % {"clearance": f"{flight.clearance_m:.0f}", "limit": f"{flight.max_agl_m:.0f}"}
    if why is Reachability.NO_LANDING:
        return _("Landing there leads through a no-fly zone.")
    if zone >= 0:
        return _("Inside %(zone)s.") % {"zone": zone_names[zone]}
    return _("A no-fly zone, or wires that cannot be flown over, lie on it.")


def _km(length_m: float) -> str:
    return f"{number_text(length_m)} m" if length_m < 1_000 else f"{number_text(length_m / 1_000, 1)} km"
