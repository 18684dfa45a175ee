"""Planning of a campaign: launch sites, one or more missions at each, and the working days of the crews that fly them."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import distance_m
from operation.reasons import Reason
from planning.campaigns.crew_days import Schedule, schedule, work_limit_s
from planning.campaigns.launch_sites import SiteChoice, choose_sites
from planning.campaigns.rules import CampaignRules
from planning.request import BaseRequest, EndAction, PlanRequest
from planning.solver.solver import Stop
from planning.trajectory.waypoints import WaypointKind

# A later mission from the same site, with full batteries, may reach targets that were left out for these.
REACHABLE_LATER = {"beyond_range", "beyond_energy", "most_targets"}
BEYOND_REACH, ASSET_GONE = "beyond_reach", "asset_gone"
MAX_MISSIONS = 200

PlanJson = dict[str, Any]  # see planning/plan_json.py
MakePlan = Callable[[PlanRequest, float], PlanJson]  # with the share of the campaign's targets that are planned


class TooManyMissions(Exception):
    """Raised where a campaign would need more than MAX_MISSIONS missions."""


class Stopped(Exception):
    """Raised when the caller stops the planning."""


@dataclass(frozen=True)
class SiteMission:
    """One mission from a launch site. targets: places in the campaign's request, in the order of `request.targets`."""

    site: int
    targets: tuple[int, ...]
    request: PlanRequest
    plan: PlanJson

    @property
    def work_s(self) -> float:
        """From the first take-off to the last landing [s]."""
        return max((route["departs_s"] + route["duration_s"] for route in self.plan["routes"] if route["targets"]), default=0.0)

    @property
    def flights(self) -> int:
        flown = [route["waypoints"] for route in self.plan["routes"] if route["targets"]]
        return sum(1 + sum(point["kind"] == WaypointKind.BASE for point in waypoints) for waypoints in flown)

    @property
    def visited(self) -> tuple[int, ...]:
        """Places in the campaign's request of the targets that it visits."""
        left_out = {item["target"] for item in self.plan["unassigned"]}
        return tuple(target for place, target in enumerate(self.targets) if place not in left_out)

    def farthest_m(self) -> float:
        """Greatest distance of a route from the launch site [m]."""
        lines = [route["geometry"]["coordinates"] for route in self.plan["routes"] if route["geometry"]]
        if not lines:
            return 0.0
        points = np.array([point[:2] for line in lines for point in line], dtype=np.float64)
        return float(distance_m(np.broadcast_to(np.array(self.request.uavs[0].position), points.shape), points).max())


@dataclass(frozen=True)
class UnvisitedTarget:
    """A target that no mission visits, by its place in the request. reason: as in plans, or BEYOND_REACH. why: Reasons as JSON."""

    target: int
    reason: str
    why: Sequence[dict[str, Any]]


@dataclass(frozen=True)
class PlannedCampaign:
    """sites: proposed ones have no name. Schedule.days and Schedule.too_long number the missions. blocked: given sites inside zones."""

    sites: tuple[BaseRequest, ...]
    blocked: tuple[BaseRequest, ...]
    missions: tuple[SiteMission, ...]
    schedule: Schedule
    left_out: tuple[UnvisitedTarget, ...]


def plan_campaign(
    courses: Sequence[Sequence[LonLat]],
    request: PlanRequest,
    rules: CampaignRules,
    *,
    may_launch_at: Callable[[LonLat], bool],
    make_plan: MakePlan,
    stop: Stop,
) -> PlannedCampaign:
    """Plan all targets of the request, whose points are `courses` in the same order; a target without points has been deleted.

    Its UAVs start from each launch site and return there. Raises TooManyMissions, Stopped, and what make_plan raises.
    """
    there = [target for target, course in enumerate(courses) if course]
    given = [site for site in rules.sites if may_launch_at(site.position)]
    blocked = tuple(site for site in rules.sites if site not in given)
    places = [site.position for site in given]
    if rules.proposes_sites:
        ends = dict.fromkeys(end for target in there for end in (courses[target][0], courses[target][-1]))
        places += [end for end in ends if may_launch_at(end)]
    choice = choose_sites([courses[target] for target in there], places, rules.reach_m, given=len(given))
    sites = tuple(given[site] if site < len(given) else BaseRequest("", places[site]) for site in choice.sites)
    missions: list[SiteMission] = []
    left_out = [
        UnvisitedTarget(there[place], BEYOND_REACH, [_why_beyond_reach(nearest_m).to_json()])
        for place, nearest_m in enumerate(choice.nearest_m)
        if choice.site_of[place] is None
    ]
    left_out += [
        UnvisitedTarget(target, ASSET_GONE, [Reason("asset_deleted").to_json()]) for target, course in enumerate(courses) if not course
    ]
    for number, site in enumerate(sites):
        planned = _AtSite(number, site.position, request, rules, make_plan, stop)
        for found in planned.missions(_targets_of(choice, number, there)):
            missions.append(found)
            if len(missions) > MAX_MISSIONS:
                raise TooManyMissions
        left_out += planned.left_out
    places_of_missions = [sites[mission.site].position for mission in missions]
    days = schedule(places_of_missions, [mission.work_s for mission in missions], rules.crews, stop=stop)
    return PlannedCampaign(sites, blocked, tuple(missions), days, tuple(sorted(left_out, key=lambda one: one.target)))


def _why_beyond_reach(nearest_m: float) -> Reason:
    return Reason("beyond_launch_sites", {"needed_m": nearest_m}) if math.isfinite(nearest_m) else Reason("no_launch_site")


def _targets_of(choice: SiteChoice, site: int, there: Sequence[int]) -> list[int]:
    return [there[place] for place, of_target in enumerate(choice.site_of) if of_target == site]


@dataclass
class _AtSite:
    """Missions from one site, each within a working day of its own."""

    number: int
    position: LonLat
    request: PlanRequest
    rules: CampaignRules
    make_plan: MakePlan
    stop: Stop

    def __post_init__(self) -> None:
        self.left_out: list[UnvisitedTarget] = []

    def missions(self, targets: Sequence[int]) -> Iterator[SiteMission]:
        """Yield the missions that visit these targets, and collect those that none can visit."""
        if not targets:
            return
        if self.stop():
            raise Stopped
        found = self._planned(targets)
        if found.work_s > work_limit_s(self.position, self.rules.crews) and len(found.visited) > 1:
            for half in _halves(found):
                yield from self.missions(half)
        elif found.visited:
            yield found
        items = {targets[item["target"]]: item for item in found.plan["unassigned"]}
        later = [target for target, item in items.items() if item["reason"] in REACHABLE_LATER and found.visited]
        self.left_out += [UnvisitedTarget(target, item["reason"], item["why"]) for target, item in items.items() if target not in later]
        yield from self.missions(later)

    def _planned(self, targets: Sequence[int]) -> SiteMission:
        uavs = tuple(
            replace(uav, position=self.position, home=None, end_action=EndAction.RETURN, sorties=self.rules.flights)
            for uav in self.request.uavs
        )
        request = replace(self.request, uavs=uavs, targets=tuple(self.request.targets[target] for target in targets), locks=(), bases=())
        return SiteMission(self.number, tuple(targets), request, self.make_plan(request, len(targets) / len(self.request.targets)))


def _halves(mission: SiteMission) -> tuple[list[int], list[int]]:
    """Return the visited targets of a mission in the order in which they are flown, in two parts."""
    order = [mission.targets[place] for route in mission.plan["routes"] for place in route["targets"]]
    return order[: len(order) // 2], order[len(order) // 2 :]
