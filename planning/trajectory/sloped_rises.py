"""Small rises of a drawn route as slopes: a UAV flies on over them, where straight up and down it all but stops, twice for each."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

SLOPE = 1.0 / 6.0  # at 14 m/s a climb of 2.3 m/s, which does not slow a UAV that climbs at 2.5 m/s
MIN_RUN_M = 15.0  # across the ground: room to pitch up and down at speed
MAX_RISE_M = 9.0  # what is higher stays straight up: a slope would begin too far before what it is for, and nearer to zones aloft


class ProfilePoint(NamedTuple):
    """A point of a route seen from the side: metres along the route, its level, and the leg on which it is put in, with its share of it.

    One of the route's own points is the start of its leg. is_fixed: its level is not to be changed; most_m: the highest that it may have.
    """

    along_m: float
    level_m: float
    leg: int
    share: float
    is_own: bool
    is_fixed: bool = False
    most_m: float = float("inf")


def with_slopes(profile: Sequence[ProfilePoint]) -> list[ProfilePoint]:
    """The profile with each small step up and down, between two points at one place, as a slope before and behind it.

    It is nowhere lower than it was, and no point higher than the top of a step beside it.
    """
    return _backward(_with_slopes_up(_backward(_with_slopes_up(list(profile)))))


def _backward(profile: Sequence[ProfilePoint]) -> list[ProfilePoint]:
    return [point._replace(along_m=-point.along_m) for point in reversed(profile)]


def _with_slopes_up(profile: list[ProfilePoint]) -> list[ProfilePoint]:
    behind = 1  # a step's top is so many points before the end: what lies behind it stays
    while behind < len(profile):
        low, top = profile[-behind - 1], profile[-behind]
        rise_m = top.level_m - low.level_m
        if low.along_m == top.along_m and 0.0 < rise_m <= MAX_RISE_M and not low.is_own:
            profile = _sloped_to(profile, len(profile) - behind, rise_m)
        behind += 1
    return profile


def _sloped_to(profile: list[ProfilePoint], top: int, rise_m: float) -> list[ProfilePoint]:
    """With a slope that ends at the top of a step; what it passes over is lifted onto it, or else nothing where that may not be."""
    slope = rise_m / max(rise_m / SLOPE, MIN_RUN_M)

    def sloped_m(point: ProfilePoint) -> float:
        return profile[top].level_m - slope * (profile[top].along_m - point.along_m)

    lifted: list[ProfilePoint] = []
    for place in range(top - 2, -1, -1):
        point, after = profile[place], profile[place + 1]
        over_m, over_after_m = sloped_m(point) - point.level_m, sloped_m(after) - after.level_m
        if over_m <= 0.0 or point.is_fixed:
            if point.along_m != after.along_m:
                lifted.append(_between(point, after, 0.0 if over_m > 0.0 else over_m / (over_m - over_after_m), sloped_m))
            elif place == top - 2:
                return profile  # down and up again at one place
            elif not after.is_own:
                lifted.append(after._replace(level_m=sloped_m(after)))
            return [*profile[: place + 1], *reversed(lifted), *profile[top:]]
        if sloped_m(point) > point.most_m:
            return profile
        if point.is_own:  # others lie on the straight leg, and so on the slope
            lifted.append(point._replace(level_m=sloped_m(point)))
    return profile


def _between(point: ProfilePoint, after: ProfilePoint, share: float, level_m_of: Callable[[ProfilePoint], float]) -> ProfilePoint:
    """A point between two, at this share from the first to the second, on the slope there."""
    is_forward = (point.leg, point.share) <= (after.leg, after.share)
    first, second, along = (point, after, share) if is_forward else (after, point, 1.0 - share)
    end = second.share if second.leg == first.leg and not second.is_own else 1.0
    along_m = point.along_m + share * (after.along_m - point.along_m)
    put_in = ProfilePoint(along_m, 0.0, first.leg, first.share + along * (end - first.share), is_own=False)
    return put_in._replace(level_m=level_m_of(put_in))
