"""UAVs that fly at the same time are kept apart: in time by when they take off, in height by layers."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from planning.rules import FlightRules, SeparationRules
from planning.separation.closest_approach import NOTHING, box_tree, nearest, shared_places
from planning.separation.route_pieces import ARRIVAL, FOREVER_S, HEIGHT, HOLD, ON_GROUND, QUICKEST_S, route_pieces, runs_on
from planning.trajectory.waypoints import BASE, END, NONE, TARGET, RoutePoints, Waypoints

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

SLACK_S = 1e-3  # a UAV that is put off is put off by so much more than it has to be, whatever rounding does
MAX_LAYERS = 8
ALWAYS_FREE = np.empty((0, 2))


@dataclass(frozen=True, eq=False)
class TimedRoute:
    """A UAV's way through air and time. Raises ValueError where its times run backwards or its columns differ in length.

    position     (n, 2), columns lon, lat [deg]
    height_m     (n,) above sea level, or above one reference that all compared routes share; NaN where it is not known. Heights above
                 unknown ground belong here as NaN: what cannot be compared counts as the same height.
    arrival_s    (n,) seconds at which each waypoint is reached, from an origin that all compared routes share
    hold_s       (n,) seconds that the UAV stays there; between waypoints it moves in straight lines at an even speed
    take_off_s   when it leaves the ground, take_off_m high, under its first waypoint; before that it is not in the air
    lands_s      when it is on the ground again, landing_m high, under its last waypoint; None where it hovers there for ever
    uav          its name, and `mission` whose it is, where that is another than the one in hand
    on_ground    (n,) where it stands on the ground for its hold, between two flights; None for nowhere. There it is in nobody's way.
    """

    uav: str
    position: FloatArray
    height_m: FloatArray
    arrival_s: FloatArray
    hold_s: FloatArray
    take_off_s: float = 0.0
    take_off_m: float = math.nan
    lands_s: float | None = None
    landing_m: float = math.nan
    mission: str | None = None
    on_ground: NDArray[np.bool_] | None = None

    def __post_init__(self) -> None:
        count = len(self.position)
        if not len(self.height_m) == len(self.arrival_s) == len(self.hold_s) == count:
            raise ValueError("position, height_m, arrival_s and hold_s must have one entry for each waypoint")
        if not count:
            return
        is_never_told = self.lands_s is not None and math.isnan(self.lands_s)
        if is_never_told or not runs_on(self._table, float(self.take_off_s), self._lands_s):
            raise ValueError("a route's times must be known and must not run backwards")

    @property
    def _lands_s(self) -> float:
        """NaN where it hovers, as compiled code reads it."""
        return math.nan if self.lands_s is None else float(self.lands_s)

    @cached_property
    def _table(self) -> FloatArray:
        table = np.zeros((len(self.position), 6))
        table[:, :HEIGHT] = self.position
        table[:, HEIGHT], table[:, ARRIVAL], table[:, HOLD] = self.height_m, self.arrival_s, self.hold_s
        if self.on_ground is not None:
            table[:, ON_GROUND] = self.on_ground
        return table

    def pieces(self, about_lon: float) -> tuple[FloatArray, IntArray]:
        """As `route_pieces` has them."""
        if not len(self.position):
            return np.empty((0, 8)), np.empty(0, dtype=np.int64)
        return route_pieces(self._table, float(self.take_off_s), float(self.take_off_m), self._lands_s, float(self.landing_m), about_lon)

    @property
    def end_s(self) -> float:
        """When it has landed, or begins to hover at its end; 0 without waypoints."""
        if not len(self.arrival_s):
            return 0.0
        return float(self.arrival_s[-1] + self.hold_s[-1]) if self.lands_s is None else self.lands_s

    def delayed(self, delay_s: float) -> "TimedRoute":
        """The same flown later."""
        if delay_s == 0.0:
            return self
        lands_s = None if self.lands_s is None else self.lands_s + delay_s
        return replace(self, arrival_s=self.arrival_s + delay_s, take_off_s=self.take_off_s + delay_s, lands_s=lands_s)


def timed_route(
    uav: str, waypoints: Waypoints, arrival_s: FloatArray, *, take_off_s: float = 0.0, lands_s: float | None, mission: str | None = None
) -> TimedRoute:
    """A planned route with the moments at which its waypoints are reached. Over unknown ground its heights cannot be compared."""
    hold_s = np.zeros(len(waypoints))
    for place, task in waypoints.points.task.items():
        hold_s[place] = task.hold_s
    height_m = np.full(len(waypoints), np.nan) if waypoints.amsl_m is None else waypoints.amsl_m
    ground_m = height_m - waypoints.points.agl_m
    ends_m = (float(ground_m[0]), float(ground_m[-1])) if len(waypoints) else (math.nan, math.nan)
    position, on_ground = waypoints.points.position, waypoints.points.kind == BASE
    return TimedRoute(uav, position, height_m, arrival_s, hold_s, take_off_s, ends_m[0], lands_s, ends_m[1], mission, on_ground)


def raised_agl_m(points: RoutePoints, layer_m: float, *, lands: bool, rules: FlightRules) -> FloatArray | None:
    """Heights above ground of a route whose transit is flown a layer higher, (n,); None where that is above the greatest height.

    Targets, and the points between two ends of one, are flown as high as before; likewise the end of a route that
    hovers over its last, or lands there.
    """
    is_transit = (points.kind != TARGET) & (points.kind != BASE) & (points.target == NONE)
    ends_at_target = not lands or len(points) < 2 or (points.position[-1] == points.position[-2]).all()
    if ends_at_target:
        is_transit &= points.kind != END
    agl_m: FloatArray = np.where(is_transit, points.agl_m + layer_m, points.agl_m)
    return agl_m if (agl_m[is_transit] <= rules.max_agl_m).all() else None


@dataclass(frozen=True)
class Encounter:
    """A place that two UAVs pass within the limits of metres, with the least time between.

    seconds apart, metres across the ground and vertical_m in height (None: not known, so taken as the same) at the moments at_s of the
    two; position is the first UAV's. Where seconds is 0 they are there at the same time, and it is the nearest they come.
    legs as TimedRoute numbers them; missions None for the one in hand. blocks: one of them hovers for ever where the
    other passes, so that waiting helps only as long as it has not come there.
    """

    uavs: tuple[str, str]
    missions: tuple[str | None, str | None]
    legs: tuple[int, int]
    position: LonLat
    at_s: tuple[float, float]
    seconds: float
    metres: float
    vertical_m: float | None
    blocks: bool


@dataclass(frozen=True, eq=False)
class _IndexedRoute:
    """A route as compiled code reads it."""

    route: TimedRoute
    pieces: FloatArray
    tree: FloatArray
    leg: IntArray

    def delayed(self, delay_s: float) -> "_IndexedRoute":
        if delay_s == 0.0:
            return self
        pieces, tree = self.pieces.copy(), self.tree.copy()
        pieces[:, 3::4] += delay_s
        tree[:, 3::4] += delay_s
        return _IndexedRoute(self.route.delayed(delay_s), pieces, tree, self.leg)


def _flown(route: TimedRoute, about_lon: float) -> _IndexedRoute:
    pieces, leg = route.pieces(about_lon)
    return _IndexedRoute(route, pieces, box_tree(pieces), leg)


def _about_lon(routes: Sequence[TimedRoute]) -> float:
    return next((float(route.position[0, 0]) for route in routes if len(route.position)), 0.0)


def _encounter(one: _IndexedRoute, other: _IndexedRoute, rules: SeparationRules, below_s: float) -> Encounter | None:
    seconds, metres, vertical_m, at_s, other_at_s, piece, other_piece = nearest(
        one.pieces, one.tree, other.pieces, other.tree, rules.lateral_m, rules.vertical_m, below_s
    )
    if seconds == NOTHING:
        return None
    flown = one.pieces[piece]
    share = (at_s - flown[3]) / (flown[7] - flown[3])
    lon, lat = (flown[:2] + share * (flown[4:6] - flown[:2])).tolist()
    return Encounter(
        (one.route.uav, other.route.uav),
        (one.route.mission, other.route.mission),
        (int(one.leg[piece]), int(other.leg[other_piece])),
        LonLat((lon + 180.0) % 360.0 - 180.0 if abs(lon) > 180.0 else lon, lat),
        (at_s, other_at_s),
        seconds,
        metres,
        None if math.isnan(vertical_m) else vertical_m,
        _hovers_in_its_way(one, other, rules) or _hovers_in_its_way(other, one, rules),
    )


def _hovers_in_its_way(hoverer: _IndexedRoute, passer: _IndexedRoute, rules: SeparationRules) -> bool:
    """Whether the first stays for ever over a place that the second passes."""
    if hoverer.route.lands_s is not None or not len(hoverer.pieces):
        return False
    hover = hoverer.pieces[-1:]
    return len(shared_places(hover, box_tree(hover), passer.pieces, passer.tree, rules.lateral_m, rules.vertical_m, 0.0)) > 0


def conflicts(routes: Sequence[TimedRoute], fixed: Sequence[TimedRoute] = (), *, rules: SeparationRules) -> tuple[Encounter, ...]:
    """For each two routes, not both of them fixed, that break the rule: where they do so worst. In the order of the routes."""
    about_lon = _about_lon(routes)
    return _conflicts([_flown(route, about_lon) for route in routes], [_flown(route, about_lon) for route in fixed], rules)


def _conflicts(own: Sequence[_IndexedRoute], others: Sequence[_IndexedRoute], rules: SeparationRules) -> tuple[Encounter, ...]:
    pairs = [*combinations(own, 2), *((one, other) for one in own for other in others)]
    found = (_encounter(one, other, rules, rules.time_s) for one, other in pairs)
    return tuple(encounter for encounter in found if encounter is not None)


def closest_encounter(routes: Sequence[TimedRoute], fixed: Sequence[TimedRoute] = (), *, rules: SeparationRules) -> Encounter | None:
    """Of all places that two routes share, whether or not they keep the rule there, the one with the least time between; None for none."""
    about_lon = _about_lon(routes)
    return _closest([_flown(route, about_lon) for route in routes], [_flown(route, about_lon) for route in fixed], rules)


def _closest(own: Sequence[_IndexedRoute], others: Sequence[_IndexedRoute], rules: SeparationRules) -> Encounter | None:
    closest: Encounter | None = None
    for one, other in [*combinations(own, 2), *((one, other) for one in own for other in others)]:
        # a little above the best, for of two places with the same time between the nearer one counts
        below_s = NOTHING if closest is None else closest.seconds + QUICKEST_S
        found = _encounter(one, other, rules, below_s)
        if found is not None and (closest is None or (found.seconds, found.metres) < (closest.seconds, closest.metres)):
            closest = found
    return closest


@dataclass(frozen=True, eq=False)
class Separation:
    """Routes kept apart: each with its delay and layer, the closest that any two come, and the conflicts that are left."""

    rules: SeparationRules
    routes: tuple[TimedRoute, ...]  # as they are to be flown
    delays_s: tuple[float, ...]
    layers_m: tuple[float, ...]
    closest: Encounter | None
    unresolved: tuple[Encounter, ...]


Raised = Callable[[int, float], TimedRoute | None]


def keep_apart(
    routes: Sequence[TimedRoute], fixed: Sequence[TimedRoute] = (), *, rules: SeparationRules, raised: Raised | None = None
) -> Separation:
    """Delays of take-off in whole seconds and, where given, height layers with which no two routes come too near to each other.

    fixed routes are never changed. raised(route, layer_m) is the route flown so much higher, with its times anew, or None where it may
    not be; layers are the rules' vertical_m, twice that, and so on. A route is put in a layer where it ends sooner than by waiting.

    Routes are placed one after another, each as early as those before it let it; the longest first, but one that passes where another
    will hover for ever before that one. Then the route that ends last is placed first as long as all end sooner by that. The same input
    has the same answer. What waiting does not solve, such as two that hover over one place, is left with no more delay than the others
    ask for, and told as unresolved.
    """
    search = _Search(routes, fixed, rules, raised)
    best = search.placed(search.first_order())
    tried: set[int] = set()
    while best.end_s > max((route.end_s for route in routes), default=0.0):
        last = best.last
        if last in tried:
            break
        tried.add(last)
        other = search.placed((last, *(route for route in best.order if route != last)))
        if other.worth < best.worth:
            best = other
    flown = [
        search.variant(number, layer).delayed(delay) for number, (layer, delay) in enumerate(zip(best.layer, best.delay_s, strict=True))
    ]
    return Separation(
        rules,
        tuple(one.route for one in flown),
        best.delay_s,
        tuple(layer * rules.vertical_m for layer in best.layer),
        _closest(flown, search.fixed, rules),
        _conflicts(flown, search.fixed, rules),
    )


@dataclass(frozen=True)
class _Placed:
    """Delays and layers that come of placing routes in an order."""

    order: tuple[int, ...]
    delay_s: tuple[float, ...]
    layer: tuple[int, ...]
    ends_s: tuple[float, ...]
    unsolved: int

    @property
    def end_s(self) -> float:
        return max(self.ends_s, default=0.0)

    @property
    def last(self) -> int:
        return max(range(len(self.ends_s)), key=lambda route: (self.ends_s[route], -route))

    @property
    def worth(self) -> tuple[int, float, float, int]:
        """The less the better."""
        return self.unsolved, self.end_s, sum(self.delay_s), sum(self.layer)


class _Search:
    """What the routes may not be delayed by against each other, worked out when it is asked for, and the placing of routes."""

    def __init__(self, routes: Sequence[TimedRoute], fixed: Sequence[TimedRoute], rules: SeparationRules, raised: Raised | None) -> None:
        self.routes, self.rules, self.raised = routes, rules, raised
        self.about_lon = _about_lon(routes)
        self.fixed = [_flown(route, self.about_lon) for route in fixed]
        self._variants: dict[tuple[int, int], _IndexedRoute | None] = {
            (number, 0): _flown(route, self.about_lon) for number, route in enumerate(routes)
        }
        self._between: dict[tuple[int, int, int, int], FloatArray] = {}
        self._to_fixed: dict[tuple[int, int], FloatArray] = {}

    def variant(self, route: int, layer: int) -> _IndexedRoute:
        flown = self._variant(route, layer)
        if flown is None:
            raise LookupError(f"route {route} has no layer {layer}")
        return flown

    def _variant(self, route: int, layer: int) -> _IndexedRoute | None:
        if (route, layer) not in self._variants:
            higher = None if self.raised is None else self.raised(route, layer * self.rules.vertical_m)
            self._variants[route, layer] = None if higher is None else _flown(higher, self.about_lon)
        return self._variants[route, layer]

    def first_order(self) -> tuple[int, ...]:
        """The longest first; one that passes where another will hover before that one, where there is no circle."""
        count = len(self.routes)
        waiting = sorted(range(count), key=lambda route: (-self.routes[route].end_s, route))
        before: dict[int, set[int]] = {route: set() for route in waiting}
        for one, other in combinations(range(count), 2):
            for hoverer, passer in ((one, other), (other, one)):
                if self.routes[hoverer].lands_s is None and _never_after(self.between(hoverer, 0, passer, 0)):
                    before[hoverer].add(passer)
        order: list[int] = []
        while waiting:
            free = next((route for route in waiting if not before[route] & set(waiting)), waiting[0])
            waiting.remove(free)
            order.append(free)
        return tuple(order)

    def between(self, route: int, layer: int, later: int, later_layer: int) -> FloatArray:
        """What `later` may not be delayed by against `route`."""
        key = (route, layer, later, later_layer)
        if key not in self._between:
            found = self._shared(self.variant(route, layer), self.variant(later, later_layer))
            self._between[key] = found
            self._between[later, later_layer, route, layer] = -found[::-1, ::-1]
        return self._between[key]

    def _to_all_fixed(self, route: int, layer: int) -> FloatArray:
        if (route, layer) not in self._to_fixed:
            found = [self._shared(other, self.variant(route, layer)) for other in self.fixed]
            self._to_fixed[route, layer] = np.concatenate(found) if found else ALWAYS_FREE
        return self._to_fixed[route, layer]

    def _shared(self, one: _IndexedRoute, other: _IndexedRoute) -> FloatArray:
        rules = self.rules
        shared: FloatArray = shared_places(one.pieces, one.tree, other.pieces, other.tree, rules.lateral_m, rules.vertical_m, rules.time_s)
        return shared

    def placed(self, order: tuple[int, ...]) -> _Placed:
        count = len(self.routes)
        delay_s, layer, ends_s = [0.0] * count, [0] * count, [0.0] * count
        unsolved = 0
        done: list[int] = []
        for route in order:
            choices = []
            for higher in range(MAX_LAYERS + 1):
                if self._variant(route, higher) is None:
                    break
                against = [self.between(other, layer[other], route, higher) + delay_s[other] for other in done]
                barred = [intervals for intervals in (self._to_all_fixed(route, higher), *against) if len(intervals)]
                wait_s, blocked = _least_wait_s(np.concatenate(barred)) if barred else (0.0, False)
                choices.append((blocked, self.variant(route, higher).route.end_s + wait_s, higher, wait_s))
                if not blocked and wait_s == 0.0:
                    break
            blocked, ends_s[route], layer[route], delay_s[route] = min(choices)
            unsolved += blocked
            done.append(route)
        return _Placed(order, tuple(delay_s), tuple(layer), tuple(ends_s), unsolved)


def _never_after(intervals: FloatArray) -> bool:
    return bool(len(intervals)) and intervals[-1, 1] > FOREVER_S / 2


def _least_wait_s(intervals: FloatArray) -> tuple[float, bool]:
    """The least whole number of seconds in none of the open intervals, and whether those without end had to be left out for it."""
    in_order = intervals[np.argsort(intervals[:, 0], kind="stable")]
    wait_s = 0.0
    for first_s, last_s in in_order.tolist():
        if first_s - SLACK_S < wait_s < last_s + SLACK_S:
            if last_s > FOREVER_S / 2:
                finite = in_order[in_order[:, 1] <= FOREVER_S / 2]
                return _least_wait_s(finite)[0], True
            wait_s = float(math.ceil(last_s + SLACK_S))
    return wait_s, False
