"""Whatever happens in whatever order - offers taken, reports, aborts, commands, steps that fail - no mission is mixed from two plans."""

import random
from collections import Counter
from collections.abc import Callable
from typing import Any

import pytest
from django.db.models import F

from missions.models import CommandAxis, CommandKind, CommandState, InspectionTarget, Mission, OfferState, ReplanOffer, Route, UavCommand
from missions.services.commands.commands import note_applied, note_failed, note_sent
from missions.services.commands.dispatch import abort_mission
from missions.services.commands.flight_progress import ON_ITS_WAY, FlightEnd, mark_flight_ended
from missions.services.commands.refused import Refused
from missions.services.commands.steering import command_uav
from missions.services.replanning import accept_offer, decline_offer, settle_offers, suggest
from tests.accounts.users import a_user
from tests.missions.commands.outbox import claim, fence
from tests.missions.flights import ground
from tests.missions.replanning.in_flight import Flight, two_in_the_air, worked_out
from workspace.models import Job, JobState

pytestmark = pytest.mark.django_db
STEPS = 14
TAKEN = (0, 1)  # in whose course an offer is taken
Happening = Callable[[Flight, random.Random], Any]


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(2, 40))])
def test_no_mission_is_mixed_from_two_plans(seed, tmp_path):
    ground(tmp_path / "hill.tif", 100.0)
    flight = two_in_the_air(a_user())
    draw, done = random.Random(seed), Counter()
    for what in _course(draw):
        try:
            what(flight, draw)
            done[what.__name__] += 1
        except Refused:
            done["refused"] += 1
        _check(flight)
    assert done["offer_worked_out"] and done.total() == STEPS
    if seed in TAKEN:
        assert ReplanOffer.objects.filter(state=OfferState.ACCEPTED).exists()


def _course(draw: random.Random) -> list[Happening]:
    """At random, but that an offer is worked out early and somebody wants to take it soon after."""
    course = draw.choices(HAPPENINGS, k=STEPS - 2)
    first = draw.randint(0, 2)
    course.insert(first, offer_worked_out)
    course.insert(draw.randint(first + 1, first + 2), offer_taken)
    return course


def offer_worked_out(flight: Flight, draw: random.Random) -> None:
    active = Mission.objects.filter(state="active").order_by("created_at").first()
    if active is None:
        return
    uav = flight.uavs[0] if draw.random() < 0.8 else flight.uavs[1]
    suggest(mission_id=active.pk, code="uav-out", cause={"uav": uav.pk})
    for job in Job.objects.filter(state=JobState.QUEUED, task="missions.tasks.replan_mission"):
        worked_out(ReplanOffer.objects.get(pk=job.parameters["offer"]), job)


def offer_taken(flight: Flight, draw: random.Random) -> None:
    for offer in ReplanOffer.objects.filter(state=OfferState.OPEN):
        accept_offer(offer=offer, actor=flight.author)


def offer_declined(flight: Flight, draw: random.Random) -> None:
    for offer in ReplanOffer.objects.filter(state=OfferState.OPEN)[: draw.randint(0, 1)]:
        decline_offer(offer=offer, actor=flight.author)


def commands_carried(flight: Flight, draw: random.Random) -> None:
    for command in claim(*flight.uavs):
        assert note_sent(command.pk, **fence(command))
        if draw.random() < 0.85:
            note_applied(command.pk, **fence(command))
        else:
            note_failed(command.pk, "refused", "The vehicle refused it.", **fence(command))


def a_uav_flies_on(flight: Flight, draw: random.Random) -> None:
    place = draw.randrange(2)
    flight.fly_to(place, draw.randrange(1, flight.route(place).waypoints.count()), draw.random())


def a_flight_fails(flight: Flight, draw: random.Random) -> None:
    mark_flight_ended(mission_id=flight.mission.pk, uav_id=flight.uavs[draw.random() < 0.2].pk, flight=1, end=FlightEnd.FAILED)


def a_flight_ends(flight: Flight, draw: random.Random) -> None:
    for mission in Mission.objects.filter(state="active"):
        mark_flight_ended(mission_id=mission.pk, uav_id=draw.choice(flight.uavs).pk, flight=1, end=FlightEnd.FLOWN)


def a_person_commands(flight: Flight, draw: random.Random) -> None:
    kind = draw.choice([CommandKind.HOLD, CommandKind.PAUSE, CommandKind.RESUME, CommandKind.RETURN, CommandKind.START])
    command_uav(uav=draw.choice(flight.uavs), kind=kind, actor=flight.author)


def a_mission_is_aborted(flight: Flight, draw: random.Random) -> None:
    if draw.random() < 0.3:
        for mission in Mission.objects.filter(state__in=ON_ITS_WAY):
            abort_mission(mission=mission, actor=flight.author, why="Storm")


HAPPENINGS = (
    offer_worked_out, offer_worked_out, offer_taken, offer_taken, offer_declined, commands_carried, commands_carried, commands_carried,
    a_uav_flies_on, a_flight_fails, a_flight_ends, a_person_commands, a_mission_is_aborted, lambda *_: settle_offers(),
)  # fmt: skip


def _check(flight: Flight) -> None:
    for uav in flight.uavs:
        flown = Route.objects.filter(mission_uav__uav=uav, mission__state__in=ON_ITS_WAY, geometry__isnull=False, continued_by=None)
        assert flown.count() <= 1, "a UAV flies in one mission"
        loads = UavCommand.objects.filter(uav=uav, axis=CommandAxis.MISSION).order_by("sequence")
        for start in UavCommand.objects.filter(uav=uav, kind=CommandKind.START, sent_at__isnull=False):
            before = loads.filter(sequence__lt=start.sequence, state=CommandState.APPLIED).last()
            assert before is not None and before.approval_id == start.approval_id, "what is started is what was loaded last"
    assert not Route.objects.exclude(graph_version=F("mission__graph_version")).exists()
    for mission in Mission.objects.exclude(state="draft").filter(approvals__isnull=False):
        approval = mission.approvals.get()
        frozen = {route["uav"]: len(route["route"]["waypoints"]) for route in approval.document["routes"]}
        stored = {route.mission_uav.uav_id: route.waypoints.count() for route in mission.routes.filter(geometry__isnull=False)}
        assert stored == frozen, "a mission is flown as it was approved"
    undecided = InspectionTarget.objects.filter(
        mission__state__in=ON_ITS_WAY, state__in=["pending", "in-progress"], waypoints__route__continued_by=None
    )
    of_assets = Counter(undecided.values_list("asset", "mission").distinct().values_list("asset", flat=True))
    assert all(number == 1 for number in of_assets.values()), "a target is to be done in one mission"
    assert not InspectionTarget.objects.filter(
        waypoints__route__continued_by__isnull=False, state__in=["pending", "in-progress"]
    ).exists(), "nothing is left undecided on a route that is given up"
    assert not ReplanOffer.objects.filter(state=OfferState.ACCEPTED, continuation__approvals=None).exists()
