"""Working days of crews: which sites each visits on which day, in which order, and when it drives.

The assignment's solver plans it: crews are its vehicles, days their sorties, and seconds its metres. It finds the fewest days, and of
those plans the one with the least driving, as the work is the same in any order.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import distance_m
from planning.problem import RANGE_RESERVE, End, FloatArray, Objective, Problem, Solution, UavStart, Visit
from planning.solver.solver import Stop, never, solve

# Roads are longer than the straight line by this factor in the mean of 66,000 places (Boscoe, Henry, Zdeb: A Nationwide Comparison of
# Driving Distance Versus Straight-Line Distance to Hospitals, The Professional Geographer 64, 2012).
ROAD_FACTOR = 1.417


@dataclass(frozen=True)
class Crews:
    """Crews that all start and end their days at one place."""

    start: LonLat
    count: int = 1
    drive_mps: float = 40.0 / 3.6
    set_up_s: float = 900.0  # at each site: from arrival to take-off, and from landing to departure, together; once a stay
    day_s: float = 8.0 * 3600.0  # from leaving the start to being back


@dataclass(frozen=True)
class SiteVisit:
    """A crew's stay at a site. Times are seconds after the crew left its start that day."""

    site: int
    drive_m: float
    drive_s: float
    arrives_s: float
    leaves_s: float


@dataclass(frozen=True)
class CrewDay:
    """crew and day count from 0. back_m and back_s: the drive to the start; ends_s: when the crew is back."""

    crew: int
    day: int
    visits: tuple[SiteVisit, ...]
    back_m: float
    back_s: float

    @property
    def ends_s(self) -> float:
        return self.visits[-1].leaves_s + self.back_s


@dataclass(frozen=True)
class Schedule:
    """days: by day, then by crew. too_long: sites with more work than a crew can do in a day, by number.

    is_proven: no schedule has fewer days or less driving.
    """

    days: tuple[CrewDay, ...]
    too_long: tuple[int, ...]
    is_proven: bool


def work_limit_s(site: LonLat, crews: Crews) -> float:
    """Return how long UAVs can work at a site in a day of its own [s]; 0 or less: the drive alone takes the day."""
    there_m = float(distance_m(np.array([crews.start]), np.array([site]))[0]) * ROAD_FACTOR
    return crews.day_s * (1.0 - 4.0 * RANGE_RESERVE) - crews.set_up_s - 2.0 * there_m / crews.drive_mps


def schedule(sites: Sequence[LonLat], work_s: Sequence[float], crews: Crews, *, stop: Stop = never, search_s: float = 0.0) -> Schedule:
    """Return the days in which the crews do the work [s] at every site. Every day keeps within the crews' working day."""
    fitting = [site for site in range(len(sites)) if work_s[site] <= work_limit_s(sites[site], crews)]
    too_long = tuple(site for site in range(len(sites)) if site not in fitting)
    if not fitting:
        return Schedule((), too_long, True)
    road_m = _road_m([crews.start, *(sites[site] for site in fitting)])
    own_s = [work_s[site] for site in fitting]
    set_up_s = crews.set_up_s * len({sites[site] for site in fitting})
    days = min(len(fitting), math.ceil((sum(own_s) + set_up_s) / crews.day_s / crews.count) + 1)
    while (solution := _solve(_before_work_s(road_m, crews), own_s, crews, days, stop, search_s)).unassigned and days < len(fitting):
        days = min(len(fitting), 2 * days)
    routes = sorted((route for of_crew in solution.sorties for route in of_crew if route), key=lambda route: fitting[route[0]])
    # The days are alike for all crews, so they are dealt out: everything is done soonest.
    made = tuple(
        _crew_day(number % crews.count, number // crews.count, [(place, fitting[place]) for place in route], work_s, crews, road_m)
        for number, route in enumerate(routes)
    )
    left = tuple(fitting[item.target] for item in solution.unassigned)
    return Schedule(made, tuple(sorted((*too_long, *left))), solution.is_proven)


def _before_work_s(road_m: FloatArray, crews: Crews) -> FloatArray:
    """Return the seconds from leaving each place to the first take-off at another one: the drive and the set-up, (n, n).

    Missions that follow each other at one site need one set-up. The first place is the start; to it there is the drive alone.
    """
    before_s = road_m / crews.drive_mps + crews.set_up_s
    before_s[1:, 1:][road_m[1:, 1:] == 0.0] = 0.0
    before_s[:, 0] -= crews.set_up_s
    return before_s


def _solve(before_s: FloatArray, work_s: Sequence[float], crews: Crews, days: int, stop: Stop, search_s: float) -> Solution:
    """Return the sites of each crew by day. A day costs as much as it can hold, so that the fewest days come first."""
    return solve(
        Problem(
            uavs=tuple(UavStart(2.0 * crews.day_s, End.RETURN, sorties=days) for _ in range(crews.count)),
            visits=tuple(Visit(place, length_m=length_s) for place, length_s in enumerate(work_s)),
            target_count=len(work_s),
            from_start_m=np.repeat(before_s[:1, 1:] + crews.day_s, crews.count, axis=0),
            between_m=before_s[1:, 1:],
            to_start_m=np.repeat(before_s[1:, :1], crews.count, axis=1),
            objective=Objective.TOTAL,
        ),
        stop=stop,
        search_s=search_s,
    )


def _road_m(places: Sequence[LonLat]) -> FloatArray:
    """Return the estimated metres by road between all places, (n, n)."""
    at, count = np.asarray(places, dtype=np.float64), len(places)
    straight_m = distance_m(np.repeat(at, count, axis=0), np.tile(at, (count, 1))).reshape(count, count)
    return straight_m * ROAD_FACTOR


def _crew_day(crew: int, day: int, route: Sequence[tuple[int, int]], work_s: Sequence[float], crews: Crews, road_m: FloatArray) -> CrewDay:
    """route: places in road_m less one, and numbers of the sites."""
    visits, at_s = [], 0.0
    before_s = _before_work_s(road_m, crews)
    stops = [0, *(place + 1 for place, _ in route)]
    for (left, right), (_, site) in zip(pairwise(stops), route, strict=True):
        drive_m = float(road_m[left, right])
        drive_s = drive_m / crews.drive_mps
        arrives_s = at_s + drive_s
        at_s += float(before_s[left, right]) + work_s[site]
        visits.append(SiteVisit(site, drive_m, drive_s, arrives_s, at_s))
    back_m = float(road_m[stops[-1], 0])
    return CrewDay(crew, day, tuple(visits), back_m, back_m / crews.drive_mps)
