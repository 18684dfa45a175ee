"""Planning of a campaign: launch sites, one or more missions at each, and the working days of the crews that fly them."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import distance_m
from operation.reasons import Reason, reason_from_json
from planning.airspace import Airspace, zone_at
from planning.campaigns.crew_days import Schedule, schedule, work_limit_s
from planning.campaigns.launch_sites import choose_sites, places_beside
from planning.campaigns.rules import CampaignRules, LaunchSite
from planning.clearance.lost_link import LostLink
from planning.plan import UnassignedTarget
from planning.request import EndAction, LostLinkRequest, PlanRequest
from planning.solver.solver import Stop
from planning.trajectory.waypoints import WaypointKind

BEYOND_REACH, ASSET_GONE, BEYOND_DAY = "beyond_reach", "asset_gone", "beyond_working_day"
NEVER_REACHED = {"inside_zone", ASSET_GONE}  # from no site, and in no later mission
MIN_WORK_S = 300.0  # a day that leaves less for flying than this at a site is not worth its drive
MAX_MISSIONS = 200
SCHEDULE_SEARCH_S = 3.0  # of a schedule that is too large to be proven
ROUNDS = 2  # of choosing sites: in the second one for targets that could not be flown from their first site

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
    def unassigned(self) -> dict[int, PlanJson]:
        """What the plan leaves out, by place in the campaign's request."""
        return {self.targets[item["target"]]: item for item in self.plan["unassigned"]}

    @property
    def flown(self) -> list[int]:
        """Places in the campaign's request of the targets that it visits, in the order in which they are flown."""
        return [self.targets[place] for route in self.plan["routes"] for place in route["targets"]]

    def farthest_m(self) -> float:
        """Greatest distance of a route from the launch site [m]."""
        lines = [route["geometry"]["coordinates"] for route in self.plan["routes"] if route["geometry"]]
        if not lines:
            return 0.0
        points = np.array([point[:2] for line in lines for point in line], dtype=np.float64)
        return float(distance_m(np.broadcast_to(np.array(self.request.uavs[0].position), points.shape), points).max())


@dataclass(frozen=True)
class PlannedCampaign:
    """sites: proposed ones have no name. Schedule.days and Schedule.too_long number the missions. blocked: given sites inside zones.

    UnassignedTarget.reason is one of plans, or BEYOND_REACH or BEYOND_DAY; its target is the place in the campaign's request.
    """

    sites: tuple[LaunchSite, ...]
    blocked: tuple[LaunchSite, ...]
    missions: tuple[SiteMission, ...]
    schedule: Schedule
    unassigned: tuple[UnassignedTarget, ...]


def at_any_site(request: PlanRequest, rules: CampaignRules) -> PlanRequest:
    """Return the request with UAVs that return to where they launch, with the flights of the rules, without locks and departure."""
    uavs = tuple(replace(uav, home=None, end_action=EndAction.RETURN, sorties=rules.flights) for uav in request.uavs)
    return replace(request, uavs=uavs, locks=(), bases=(), departs_at=None, return_to_start=True)


def plan_campaign(
    courses: Sequence[Sequence[LonLat]],
    request: PlanRequest,
    rules: CampaignRules,
    *,
    airspace: Airspace,
    make_plan: MakePlan,
    stop: Stop,
) -> PlannedCampaign:
    """Plan all targets of the request, whose points are `courses` in the same order; a target without points has been deleted.

    Its UAVs start from each launch site and return there. Raises TooManyMissions, Stopped, and what make_plan raises.
    """
    given = [site for site in rules.sites if zone_at(site.position, airspace) is None]
    places = list(given)
    if rules.proposes_sites:
        places += [LaunchSite("", place) for place in places_beside([course for course in courses if course], airspace)]
    work = _Work(courses, at_any_site(request, rules), rules, make_plan, stop)
    todo = [target for target, course in enumerate(courses) if course]
    work.leave_out((target for target, course in enumerate(courses) if not course), ASSET_GONE, Reason("asset_deleted"))
    for _ in range(ROUNDS):
        todo = work.fly_from(places, given, todo)
        places = [place for place in places if place not in work.sites]
        if not todo:
            break
    days = schedule(
        [work.sites[mission.site].position for mission in work.missions],
        [mission.work_s for mission in work.missions],
        rules.crews,
        stop=stop,
        search_s=SCHEDULE_SEARCH_S,
    )
    if stop():
        raise Stopped
    unassigned = tuple(sorted(work.unassigned.values(), key=lambda one: one.target))
    blocked = tuple(site for site in rules.sites if site not in given)
    return PlannedCampaign(tuple(work.sites), blocked, tuple(work.missions), days, unassigned)


@dataclass
class _Work:
    """What is planned so far. unassigned: of each target that no mission visits yet, why."""

    courses: Sequence[Sequence[LonLat]]
    request: PlanRequest
    rules: CampaignRules
    make_plan: MakePlan
    stop: Stop
    sites: list[LaunchSite] = field(default_factory=list)
    missions: list[SiteMission] = field(default_factory=list)
    unassigned: dict[int, UnassignedTarget] = field(default_factory=dict)

    def leave_out(self, targets: Sequence[int] | Iterator[int], reason: str, why: Reason) -> None:
        for target in targets:
            self.unassigned[target] = UnassignedTarget(target, reason, (why,))

    def fly_from(self, places: Sequence[LaunchSite], given: Sequence[LaunchSite], targets: Sequence[int]) -> list[int]:
        """Choose sites for these targets and plan their missions. Returns the targets that might be flown from another site."""
        nearby = [place for place in places if work_limit_s(place.position, self.rules.crews) >= MIN_WORK_S]
        known = sum(place in given for place in nearby)
        courses = [self.courses[target] for target in targets]
        choice = choose_sites(
            courses,
            [place.position for place in nearby],
            self.rules.reach_m,
            given=known,
            required=[number for number, place in enumerate(nearby) if place.is_required],
            stop=self.stop,
        )
        if self.stop():
            raise Stopped
        for target, place, nearest_m in zip(targets, choice.site_of, choice.nearest_m, strict=True):
            if place is None and target not in self.unassigned:
                self._leave_out_without_site(target, nearest_m, has_far_sites=len(nearby) < len(places))
        failed = []
        for number, place in enumerate(choice.sites):
            self.sites.append(nearby[place])
            own = [target for target, of_target in zip(targets, choice.site_of, strict=True) if of_target == number]
            for target, item in self._fly(len(self.sites) - 1, own).items():
                self.unassigned[target] = UnassignedTarget(target, item["reason"], tuple(map(reason_from_json, item["why"])))
                if item["reason"] not in NEVER_REACHED:
                    failed.append(target)
        return sorted(failed)

    def _leave_out_without_site(self, target: int, nearest_m: float, *, has_far_sites: bool) -> None:
        if has_far_sites and not nearest_m <= self.rules.reach_m:
            self.leave_out([target], BEYOND_DAY, Reason("drive_takes_day"))
        elif math.isfinite(nearest_m):
            self.leave_out([target], BEYOND_REACH, Reason("beyond_launch_sites", {"needed_m": nearest_m}))
        else:
            self.leave_out([target], BEYOND_REACH, Reason("no_launch_site"))

    def _fly(self, site: int, targets: Sequence[int]) -> dict[int, PlanJson]:
        """Plan the missions that visit these targets from a site, each within a day of its own. Returns what none of them visits.

        A mission holds what it visits and nothing else: what it leaves out belongs to a later one, or to none.
        """
        if not targets:
            return {}
        found = self._planned(site, targets)
        unassigned, flown = found.unassigned, found.flown
        if not flown:
            return unassigned
        left: dict[int, PlanJson] = {}
        if unassigned:
            left |= self._fly(site, sorted(flown))
            never = {target: item for target, item in unassigned.items() if item["reason"] in NEVER_REACHED}
            return left | never | self._fly(site, [target for target in unassigned if target not in never])
        if found.work_s > work_limit_s(self.sites[site].position, self.rules.crews) and len(flown) > 1:
            half = len(flown) // 2
            return self._fly(site, sorted(flown[:half])) | self._fly(site, sorted(flown[half:]))
        self.missions.append(found)
        for target in flown:
            self.unassigned.pop(target, None)
        if len(self.missions) > MAX_MISSIONS:
            raise TooManyMissions
        return left

    def _planned(self, site: int, targets: Sequence[int]) -> SiteMission:
        if self.stop():
            raise Stopped
        position = self.sites[site].position
        request = replace(
            self.request,
            uavs=tuple(replace(uav, position=position) for uav in self.request.uavs),
            targets=tuple(self.request.targets[target] for target in targets),
            lost_link=_lost_link_at(position, self.request.lost_link, self.rules.reach_m),
        )
        return SiteMission(site, tuple(targets), request, self.make_plan(request, len(targets) / len(self.request.targets)))


def _lost_link_at(site: LonLat, wanted: LostLinkRequest, reach_m: float) -> LostLinkRequest:
    """Return the lost-link action with the rally points in reach of the site."""
    if wanted.behaviour is LostLink.GO_ON or not wanted.rally_points:
        return wanted
    away_m = distance_m(np.tile(np.array(site), (len(wanted.rally_points), 1)), np.array(wanted.rally_points))
    near = tuple(point for point, metres in zip(wanted.rally_points, away_m, strict=True) if metres <= reach_m)
    return replace(wanted, rally_points=near)
