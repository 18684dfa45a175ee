"""Manoeuvres: hold, take-off, go to, circle, return and land. A mission is another one, composed of these."""

import math
from typing import Protocol

from simulation.flight.course import Vector, Via
from simulation.flight.manoeuvre_context import ManoeuvreContext
from simulation.flight.states import FlightMode

INSIDE_M = 0.1  # how far the chords may lie inside the circle
MAX_RAD = math.radians(15.0)  # of one chord
AT_HEIGHT_M = 0.5
OVER_PLACE_M = 0.5


def around(centre: Vector, start: Vector, turns: float, radius_m: float) -> list[Vector]:
    """Return the points of a circle, clockwise from above from the point nearest to `start`; a negative radius turns the other way.

    The points are at the height of the centre. Without turns the result is the first point only.
    """
    radius = abs(radius_m)
    begin = math.atan2(start[0] - centre[0], start[1] - centre[1])
    whole = 2.0 * math.pi * turns
    widest = min(MAX_RAD, 2.0 * math.acos(max(1.0 - INSIDE_M / radius, 0.0))) if radius > 0.0 else whole
    chords = max(math.ceil(whole / widest), 1) if whole > 0.0 and radius > 0.0 else 0
    step = math.copysign(whole / chords, radius_m) if chords else 0.0
    bearings = [begin + step * number for number in range(chords + 1)]
    return [(centre[0] + radius * math.sin(bearing), centre[1] + radius * math.cos(bearing), centre[2]) for bearing in bearings]


class Manoeuvre(Protocol):
    """Call `begin` once, then `step` before each guidance step; `is_done` when complete.

    `is_landing`: ground contact is intended. `lifts_off`: it can begin on the ground.
    """

    mode: FlightMode
    lifts_off: bool
    is_done: bool

    @property
    def is_landing(self) -> bool: ...

    def begin(self, context: ManoeuvreContext) -> None: ...

    def step(self, context: ManoeuvreContext) -> None: ...


class Hold:
    """Stops and holds."""

    mode = FlightMode.HOLD
    lifts_off = False
    is_landing = False
    is_done = False

    def begin(self, context: ManoeuvreContext) -> None:
        context.stand()

    def step(self, context: ManoeuvreContext) -> None:
        pass


class TakeOffManoeuvre:
    """Climbs vertically to a height above home."""

    mode = FlightMode.TAKE_OFF
    lifts_off = True
    is_landing = False

    def __init__(self, height_m: float) -> None:
        self._height_m = height_m
        self.is_done = False

    def begin(self, context: ManoeuvreContext) -> None:
        east_m, north_m, up_m = context.here
        self.is_done = context.is_in_air and up_m >= self._height_m - AT_HEIGHT_M
        if self.is_done:
            context.stand()
        else:
            context.fly_to((east_m, north_m, self._height_m))

    def step(self, context: ManoeuvreContext) -> None:
        self.is_done = self.is_done or context.is_there(AT_HEIGHT_M)


class GoTo:
    """Flies to a place and holds there."""

    mode = FlightMode.GO_TO
    lifts_off = False
    is_landing = False
    is_done = False

    def __init__(self, place: Vector) -> None:
        self._place = place

    def begin(self, context: ManoeuvreContext) -> None:
        context.fly_to(self._place)

    def step(self, context: ManoeuvreContext) -> None:
        pass


class AroundManoeuvre:
    """Flies to the nearest point of a circle, the given turns around its centre, and stops; see `around`."""

    mode = FlightMode.GO_TO
    lifts_off = False
    is_landing = False

    def __init__(self, centre: Vector, turns: float, radius_m: float) -> None:
        self._centre, self._turns, self._radius_m = centre, turns, radius_m
        self.is_done = False

    def begin(self, context: ManoeuvreContext) -> None:
        context.fly_through([Via(point, context.speed_mps) for point in around(self._centre, context.here, self._turns, self._radius_m)])

    def step(self, context: ManoeuvreContext) -> None:
        self.is_done = self.is_done or context.is_there(AT_HEIGHT_M)


class Land:
    """Flies above the place at its present height, or stays above its position, and descends. Ground contact ends the manoeuvre."""

    mode = FlightMode.LAND
    lifts_off = False

    def __init__(self, place: Vector | None = None) -> None:
        self._place = place
        self.is_landing = False
        self.is_done = False

    def begin(self, context: ManoeuvreContext) -> None:
        if self._place is None or math.dist(self._place[:2], context.here[:2]) < OVER_PLACE_M:
            context.stand()
        else:
            context.fly_to((self._place[0], self._place[1], context.here[2]))

    def step(self, context: ManoeuvreContext) -> None:
        if not context.is_in_air:
            self.is_done = True
        elif not self.is_landing and context.is_there(OVER_PLACE_M):
            self.is_landing = True
            context.guidance.descend(self._place or context.guidance.goal)


class Return:
    """Climbs to the RTL height, flies home or to a nearer rally point, and lands. Near the destination it does not climb."""

    mode = FlightMode.RETURN
    lifts_off = False

    def __init__(self) -> None:
        self._land: Land | None = None
        self._is_climbing = False
        self._level_m = 0.0
        self._goal: Vector = (0.0, 0.0, 0.0)
        self.is_done = False

    @property
    def is_landing(self) -> bool:
        return self._land is not None and self._land.is_landing

    def begin(self, context: ManoeuvreContext) -> None:
        east_m, north_m, up_m = context.here
        settings = context.settings
        self._goal = context.nearest_rally_point()
        goal_m = self._goal[2]
        wanted_m = goal_m + settings.return_height_m if settings.return_adds_to_rally_point else max(goal_m, settings.return_height_m)
        is_near = math.dist(self._goal[:2], context.here[:2]) <= settings.return_near_m
        self._level_m = up_m if is_near else max(up_m, wanted_m)
        self._is_climbing = self._level_m > up_m + AT_HEIGHT_M
        if self._is_climbing:
            context.fly_to((east_m, north_m, self._level_m))
        else:
            self._go_there(context)

    def _go_there(self, context: ManoeuvreContext) -> None:
        self._is_climbing = False
        self._land = Land(self._goal)
        self._land.begin(context)

    def step(self, context: ManoeuvreContext) -> None:
        if self._is_climbing:
            if context.is_there(AT_HEIGHT_M):
                self._go_there(context)
        elif self._land is not None:
            self._land.step(context)
            self.is_done = self._land.is_done
