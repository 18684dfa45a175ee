"""Missions in the air: two UAVs on a line, each somewhere on its route, as the rows tell it."""

from dataclasses import dataclass, replace
from typing import Any

from django.contrib.gis.geos import Point
from django.utils import timezone

from missions.models import CommandKind, Mission, ReplanOffer, Route, Uav
from missions.selectors.missions import mission_of_organisation
from missions.services import create_mission, plan_mission
from missions.services.approval.approval import approve_mission
from missions.services.commands.dispatch import dispatch_mission
from missions.services.commands.flight_progress import mark_waypoint_reached
from missions.services.commands.steering import command_uav
from missions.services.replanning import ask_for_offer, work_out_for_job
from planning.energy.performance import Performance
from planning.problem import Objective
from planning.request import EndAction
from planning.solver.solver import never
from tests.inspection import ground
from tests.missions import worlds
from tests.missions.commands.outbox import claim
from tests.missions.flights import carry, fleet
from workspace.jobs.services import start_job
from workspace.models import Job, User

SPACING_DEG = 0.005  # of towers: 311 m


@dataclass
class Flight:
    """`mission` is active: all its UAVs were started. The tests move them."""

    mission: Mission
    uavs: list[Uav]
    author: User

    def route(self, place: int) -> Route:
        return self.mission.routes.get(mission_uav__sequence=place)

    def targets(self, place: int) -> list[int]:
        """In the order flown, by their places in the mission."""
        rows = self.route(place).waypoints.filter(kind="target").order_by("sequence")
        return list(rows.values_list("target__sequence", flat=True))

    def fly_to(self, place: int, waypoint: int, share: float = 0.5, **facts: Any) -> None:
        """To a share of the leg to a waypoint; those before it are reached."""
        rows = list(self.route(place).waypoints.order_by("sequence"))
        before, ahead = rows[waypoint - 1].position, rows[waypoint].position
        lon, lat = (one + share * (other - one) for one, other in zip(before.coords[:2], ahead.coords[:2], strict=True))
        uav = self.uavs[place]
        for passed in range(waypoint):
            mark_waypoint_reached(mission_id=self.mission.pk, uav_id=uav.pk, waypoint=passed)
        reported = {"location": Point(lon, lat, srid=4326), "located_at": timezone.now(), **facts}
        Uav.objects.filter(pk=uav.pk).update(**reported)

    def offer(self) -> ReplanOffer:
        """Asked for, and worked out."""
        offer, job = ask_for_offer(mission=self.mission, actor=self.author)
        return worked_out(offer, job)


def worked_out(offer: ReplanOffer, job: Job) -> ReplanOffer:
    held = start_job(job_id=job.pk)
    assert held is not None
    work_out_for_job(job=held, stop=never, search_s=0.0, note=lambda share, words: None)
    offer.refresh_from_db()
    return offer


def two_in_the_air(author: User, *, battery_wh: float | None = None, **wishes: Any) -> Flight:
    """Over a line of towers, one UAV from either end, each with its half of the line; both have just been started."""
    uavs = fleet("Tern", "Kite", battery_wh=battery_wh)
    return started(author, uavs, planned_over_a_line(author, uavs, battery_wh=battery_wh, **wishes))


def planned_over_a_line(author: User, uavs: list[Uav], *, towers: int = 10, battery_wh: float | None = None, **wishes: Any) -> Mission:
    standing = [ground.tower((10.0 + SPACING_DEG * number, worlds.LINE_LAT)) for number in range(towers)]
    worlds.power_line(standing, voltages_v=[110_000])
    worlds.rebuild()
    east = 10.0 + SPACING_DEG * (towers - 1)
    starts = [(9.999, worlds.LINE_LAT - 0.003), (east + 0.001, worlds.LINE_LAT - 0.003)]
    asked = tuple(
        replace(worlds.uav(start, name=uav.name, end_action=EndAction.RETURN, performance=Performance(battery_wh=battery_wh)), uav=uav.pk)
        for uav, start in zip(uavs, starts, strict=True)
    )
    request = worlds.request(*standing, uavs=asked, objective=Objective.MAKESPAN, **wishes)
    draft = create_mission(organisation=author.organisation, author=author, name="Bexley spring", request=request)
    return plan_mission(mission=draft, actor=author)


def started(author: User, uavs: list[Uav], mission: Mission) -> Flight:
    """All of them, as rows tell it."""
    approve_mission(mission=mission, actor=author)
    dispatch_mission(mission=mission, actor=author)
    carry(*uavs)
    for uav in uavs:
        command_uav(uav=uav, kind=CommandKind.START, actor=author)
    carry(*uavs)
    assert not claim(*uavs)
    flight = Flight(mission_of_organisation(author.organisation, mission.pk), uavs, author)
    for place in range(len(uavs)):
        flight.fly_to(place, 1, 0.1)
    return flight
