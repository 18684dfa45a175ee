"""Obstacles and zones on the RTL path: an autopilot commanded to return or abort flies by its own parameters."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from enum import StrEnum

import numpy as np
from django.conf import settings
from django.db.models.functions import Now
from django.utils.translation import gettext as _
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from inspection.network.spans import spans_of
from inspection.selectors import ground_heights_m
from inspection.selectors.planning import planning_read
from inspection.zones.reach import ZoneTable
from mavlink.approved_route import Flight, NotARoute
from mavlink.fence import fence_of
from mavlink.rtl import NAMES, PARAMETERS, RtlBehaviour, fence_off_by, rtl_behaviour
from missions.models import LinkKind, Mission, Route, Uav
from missions.selectors.zones import departure_s, zone_margins
from missions.services.approval.document import frozen_route
from missions.services.approval.fence import rally_points, zones_beside
from planning.clearance.nearby_zones import zones_near
from planning.clearance.rtl_paths import InTheWay, Places, ReturnPoint, RtlObstruction, RtlPaths
from planning.clearance.surroundings import Surroundings
from planning.clearance.zone_clearance import ZoneFacts

STEP_M = 5.0  # step of the search for a clear height


class ReturnState(StrEnum):
    CLEAR = "clear"
    IN_THE_WAY = "in_the_way"
    UNKNOWN = "unknown"  # its path: not read from it, or not straight
    NOT_CHECKED = "not_checked"  # it cannot be checked here


@dataclass(frozen=True)
class ReturnCheck:
    """The check of one UAV; `place` is its place in a mission, None without one.

    `height_m` counts from its take-off; `warnings` are sentences, empty where the path is clear.

    `fence_warning` states that its autopilot ignores the mission's fence; empty where it does not, or where that is unknown.
    `safe_height_m` is a height without obstacles; None where the path is clear, or where no height is.
    `detail` names parameters of the autopilot that were not read, for its installer; empty where there are none.
    """

    place: int | None
    name: str
    uav: int | None
    state: ReturnState
    warnings: tuple[str, ...] = ()
    parameter: str | None = None
    height_m: float | None = None
    safe_height_m: float | None = None
    read_at: datetime | None = None
    fence_warning: str = ""
    detail: str = ""


def note_rtl_behaviour(*, uav_id: int, autopilot: str, parameters: dict[str, float]) -> None:
    """Store RTL parameters just read from the vehicle, and ignore others. This is no edit: the row's revision stays."""
    own = {name: value for name, value in parameters.items() if name in NAMES.get(autopilot, ())}
    if own:
        autopilot_return = {"autopilot": autopilot, "parameters": own}
        Uav.objects.filter(pk=uav_id).update(autopilot_return=autopilot_return, autopilot_return_read_at=Now())


def return_checks(mission: Mission) -> list[ReturnCheck]:
    """Return a check for each UAV with a route, of a mission as loaded by selectors.mission_of_organisation. Raises NoGraph."""
    routes = [route for route in mission.routes.all() if route.geometry is not None]
    return [replace(_check(mission, route), fence_warning=_fence_warning(mission, route)) for route in routes]


def _fence_warning(mission: Mission, route: Route) -> str:
    uav = route.mission_uav.uav
    autopilot_return = {} if uav is None or uav.link != LinkKind.MAVLINK else uav.autopilot_return
    off_by = fence_off_by(autopilot_return.get("autopilot", ""), autopilot_return.get("parameters", {}))
    if not off_by:
        return ""
    try:
        fence = fence_of(zones_beside(route, departure_s(mission)), frozen_route(route, mission))
    except NotARoute:
        return ""
    words = _("%(uav)s ignores the fence that goes with the mission: its autopilot has %(parameter)s.")
    return words % {"uav": route.mission_uav.name, "parameter": off_by} if fence.items else ""


@dataclass(frozen=True)
class ReportedReturn:
    """RTL behaviour of a UAV, as read from it: `own` is None where that is unknown, and `why` is the reason."""

    own: RtlBehaviour | None
    state: ReturnState = ReturnState.CLEAR
    why: str = ""
    parameter: str | None = None
    height_m: float | None = None
    read_at: datetime | None = None
    detail: str = ""

    def check(self, place: int | None, name: str, uav: int | None) -> ReturnCheck:
        """Return the check of a UAV so far."""
        warnings = (self.why,) if self.why else ()
        return ReturnCheck(place, name, uav, self.state, warnings, self.parameter, self.height_m, read_at=self.read_at, detail=self.detail)


def reported_return(uav: Uav | None, name: str, *, has_rally: bool) -> ReportedReturn:
    """Return the RTL behaviour read from a UAV. has_rally: its mission has rally points, so the ones onboard are known."""
    values = {"uav": name}
    if uav is None:
        words = _("%(uav)s is not a UAV of the fleet: how it returns is not known.")
        return ReportedReturn(None, ReturnState.UNKNOWN, words % values)
    if uav.link == LinkKind.HTTP:
        words = _("Return path of %(uav)s unknown: its companion computer decides. Nothing on it is checked.")
        return ReportedReturn(None, ReturnState.NOT_CHECKED, words % values)
    autopilot_return = uav.autopilot_return
    own = rtl_behaviour(autopilot_return.get("autopilot", ""), autopilot_return.get("parameters", {}))
    if own is None:
        words = _("Return altitude of %(uav)s not reported by the autopilot. Its return path is not checked against terrain and zones.")
        return ReportedReturn(None, ReturnState.UNKNOWN, words % values, detail=_height_names(autopilot_return.get("autopilot", "")))
    reported = ReportedReturn(own, parameter=own.parameter, height_m=own.height_m, read_at=uav.autopilot_return_read_at)
    unknown = _why_unknown(own, name, has_rally=has_rally)
    return replace(reported, own=None, state=ReturnState.UNKNOWN, why=unknown, detail=own.untold) if unknown else reported


def _check(mission: Mission, route: Route) -> ReturnCheck:
    flown_by = route.mission_uav
    rally = rally_points(mission, flown_by.sequence)
    reported = reported_return(flown_by.uav, flown_by.name, has_rally=bool(rally))
    checked = reported.check(flown_by.sequence, flown_by.name, flown_by.uav_id)
    if reported.own is None:
        return checked
    try:
        flights = frozen_route(route, mission).flights
    except NotARoute:
        return replace(checked, state=ReturnState.NOT_CHECKED)
    table, ways = _ways(mission, route, flights, shuns_home=reported.own.shuns_home)
    return checked_ways(checked, reported.own, ways, table)


def checked_ways(checked: ReturnCheck, own: RtlBehaviour, ways: Sequence[RtlPaths], table: ZoneTable, *, where: str = "") -> ReturnCheck:
    """Return the check with the obstructions on these paths. where: text for their start; empty: waypoints of a route, by their numbers."""
    found = [obstruction for way in ways for obstruction in way.obstructions(_levels(way, own))]
    if not found:
        return checked
    safe_m = _safe_height_m(ways, own)
    warnings = [*dict.fromkeys(_words(obstruction, table, where) for obstruction in found), _advice(own, safe_m)]
    return replace(checked, state=ReturnState.IN_THE_WAY, warnings=tuple(warnings), safe_height_m=safe_m)


@dataclass(frozen=True, eq=False)
class WaysNow:
    """RTL paths from where a UAV may be now, and the zones that apply meanwhile."""

    ways: tuple[RtlPaths, ...]
    table: ZoneTable

    def checked(self, check: ReturnCheck, own: RtlBehaviour) -> ReturnCheck:
        """Return the check with the obstructions on these paths."""
        return checked_ways(check, own, self.ways, self.table, where=_("From where it is now"))

    def clear_heights_m(self, own: RtlBehaviour, lowest_m: float, step_m: float) -> list[float]:
        """Return the heights from `lowest_m` on, `step_m` metres apart, that are clear and permitted for flights."""
        most_m = settings.FLIGHT_RULES.max_agl_m
        found, height_m = [], float(math.ceil(lowest_m))
        while height_m <= most_m:
            levels = [_levels(way, own.at_height(height_m)) for way in self.ways]
            pairs = list(zip(self.ways, levels, strict=True))
            if all(way.most_agl_m(levels_m) <= most_m and not way.obstructions(levels_m) for way, levels_m in pairs):
                found.append(height_m)
            height_m += step_m
        return found


def ways_now(
    own: RtlBehaviour, places: Places, home: LonLat, rally: Sequence[tuple[LonLat, float]], window: tuple[float, float]
) -> WaysNow:  # fmt: skip
    """Return the RTL paths from positions at which a UAV may be now, to its home or to the rally point it would take instead.

    window: from when to when it returns, in seconds since the epoch. Raises NoGraph.
    """
    ground = planning_read().ground()
    home_amsl_m = float(ground_heights_m(np.array([home]))[0])
    positions = np.concatenate([places.position, np.array([home, *(place for place, _height_m in rally)])])
    near, facts = zones_applying(ground.table, positions, window)
    around = Surroundings(facts, zone_margins(), ground_heights_m, spans_of(ground.network()))
    return_points = [ReturnPoint(place, float(math.ceil(height_m)), is_rally=True) for place, height_m in rally]
    ways = [
        RtlPaths(
            own_places, return_point, around=around, home_amsl_m=None if math.isnan(home_amsl_m) else home_amsl_m,
            clearance_m=settings.FLIGHT_RULES.clearance_m,
        )
        for return_point, own_places in _places_by_return_point(places, ReturnPoint(home), return_points, shuns_home=own.shuns_home)
    ]  # fmt: skip
    return WaysNow(tuple(ways), near)


def zones_applying(table: ZoneTable, positions: NDArray[np.float64], window: tuple[float, float]) -> tuple[ZoneTable, ZoneFacts]:
    """Return the zones near positions (n, 2), lon, lat [deg], that apply at any moment of a window."""
    margins = zone_margins()
    near, _facts = zones_near(table, positions, margins)
    in_force = near.only(near.active_within(window[0] - margins.time_s, window[1] + margins.time_s)) if len(near) else near
    return zones_near(in_force, positions, margins, window)


def _why_unknown(own: RtlBehaviour, name: str, *, has_rally: bool) -> str:
    """Return why the UAV's RTL path is unknown; empty where it is known."""
    if own.untold:
        words = _("Return path of %(uav)s unknown: its autopilot has not reported how it returns. It is not checked.")
        return words % {"uav": name}
    if own.bends_by:
        words = _("By %(parameter)s %(uav)s does not return straight at one altitude: its return path is unknown, and not checked.")
        return words % {"uav": name, "parameter": own.bends_by}
    if own.rally_points and not has_rally:
        words = _("%(uav)s has rally points of another mission: its return path is unknown, and not checked.")
        return words % {"uav": name}
    return ""


def _height_names(autopilot: str) -> str:
    """Return the parameters that set the return altitude: the autopilot's, or those of all types where its type is unknown."""
    own = {autopilot: PARAMETERS[autopilot]} if autopilot in PARAMETERS else PARAMETERS
    return " / ".join(dict.fromkeys(name for groups in own.values() for name in groups[0]))


def _ways(mission: Mission, route: Route, flights: Sequence[Flight], *, shuns_home: bool) -> tuple[ZoneTable, list[RtlPaths]]:
    """Return for each flight the paths home from everywhere, and to the nearest rally point from where it is nearer, or from everywhere."""
    ground, margins = planning_read().ground(), zone_margins()
    rally = rally_points(mission, route.mission_uav.sequence)
    positions = [waypoint.position for flight in flights for waypoint in flight.waypoints]
    positions += [flight.take_off.position for flight in flights] + [place for place, _height_m in rally]
    began_s = departure_s(mission)
    window = None
    if began_s is not None:
        departs_s = began_s + route.departs_s
        window = (departs_s, departs_s + route.duration_s + settings.FLIGHT_RULES.longest_flight_s)
    near, facts = zones_near(ground.table, np.array(positions, dtype=np.float64), margins, window)
    around = Surroundings(facts, margins, ground_heights_m, spans_of(ground.network()))
    ways = []
    for flight in flights:
        return_points = [ReturnPoint(place, float(math.ceil(height_m - flight.above_first_m)), is_rally=True) for place, height_m in rally]
        along = Places.along(
            np.array([waypoint.position for waypoint in flight.waypoints], dtype=np.float64),
            np.array([waypoint.altitude_relative_m for waypoint in flight.waypoints], dtype=np.float64),
            [waypoint.sequence for waypoint in flight.waypoints],
        )
        for return_point, places in _places_by_return_point(
            along, ReturnPoint(flight.take_off.position), return_points, shuns_home=shuns_home
        ):
            ways.append(
                RtlPaths(
                    places, return_point, around=around, home_amsl_m=flight.take_off.altitude_amsl_m,
                    clearance_m=settings.FLIGHT_RULES.clearance_m,
                )
            )  # fmt: skip
    return near, ways


def _places_by_return_point(
    places: Places, home: ReturnPoint, rally: Sequence[ReturnPoint], *, shuns_home: bool
) -> Iterable[tuple[ReturnPoint, Places]]:
    yield home, places
    if not rally:
        return
    goals = rally if shuns_home else [home, *rally]
    nearest = places.nearest_of([return_point.position for return_point in goals])
    for number, return_point in enumerate(goals):
        if return_point is home:
            continue
        own = places.only(nearest == number)
        if len(own):
            yield return_point, own


def _levels(way: RtlPaths, own: RtlBehaviour) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return way.levels_m(own.level_m)


def _safe_height_m(ways: Sequence[RtlPaths], own: RtlBehaviour) -> float | None:
    """Return the lowest clear height for all paths within the flight limit, in whole metres or slightly above; None without one."""
    most_m = settings.FLIGHT_RULES.max_agl_m
    highest_m = max(most_m, *(way.most_agl_m(_levels(way, own)) for way in ways))
    lowest_m = max(own.height_m, *(way.lowest_safe_m() for way in ways))
    if not math.isfinite(lowest_m):
        return None
    height_m = float(math.ceil(lowest_m))
    while height_m <= most_m:
        other = own.at_height(height_m)
        levels = [_levels(way, other) for way in ways]
        if any(way.most_agl_m(levels_m) > highest_m for way, levels_m in zip(ways, levels, strict=True)):
            return None
        if not any(way.obstructions(levels_m) for way, levels_m in zip(ways, levels, strict=True)):
            return height_m
        height_m += STEP_M
    return None


def _along(obstruction: RtlObstruction) -> str:
    """Return the text for the part of a route from which the obstruction exists."""
    values = {"first": obstruction.first + 1, "last": obstruction.last + 1}
    if obstruction.to_end and obstruction.last > obstruction.first:
        return _("From waypoint %(first)s on") % values
    if obstruction.last > obstruction.first:
        return _("Between waypoints %(first)s and %(last)s") % values
    return _("On the way to waypoint %(first)s") % values


def _words(obstruction: RtlObstruction, table: ZoneTable, where: str) -> str:
    goes = _("the path to the rally point") if obstruction.is_rally else _("the return path")
    zone = "" if obstruction.zone is None else table.names[obstruction.zone]
    values = {"where": where or _along(obstruction), "way": goes, "zone": zone, "height": f"{obstruction.level_m:.0f}"}
    return {
        InTheWay.ZONE: _("%(where)s, %(way)s crosses %(zone)s (%(height)s m above take-off)."),
        InTheWay.OBSTACLE: _("%(where)s, %(way)s is below safe clearance over towers or conductors (%(height)s m above take-off)."),
        InTheWay.GROUND: _("%(where)s, %(way)s is too close to the ground (%(height)s m above take-off)."),
        InTheWay.UNKNOWN_GROUND: _("%(where)s, the terrain below %(way)s is unknown."),
    }[obstruction.kind] % values


def _advice(own: RtlBehaviour, safe_m: float | None) -> str:
    if safe_m is None:
        return _("No height of %(parameter)s is clear: use Hold and Land instead.") % {"parameter": own.parameter}
    values = {"parameter": own.parameter, "value": own.value_for(safe_m)}
    return _("Set %(parameter)s on it to at least %(value)s, or use Hold and Land instead.") % values
