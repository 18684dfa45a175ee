"""Planned delays keep UAVs apart only if they are kept: a start beside one that is in the air waits for its time."""

from datetime import timedelta

import pytest
from django.utils import timezone

from missions.models import CommandKind, Mission, MissionUav, Route, Uav, UavCommand, UavState
from missions.selectors.given import given_to
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended
from missions.services.commands.refused import Refused
from missions.services.commands.start_slots import reasons_to_carry_later, reasons_to_wait
from missions.services.commands.steering import command_uav
from telemetry.models import UavLink, UavWatch
from telemetry.services.latest import time_text
from telemetry.services.links.uav_outbox import handed_to
from tests.accounts.users import client_of
from tests.missions.api import post
from tests.missions.flights import an_operator, carry, dispatched, fleet
from tests.missions.worlds import UAV_AT, world
from workspace.models import User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return an_operator()


@pytest.fixture
def crossing(person: User) -> tuple[Mission, list[MissionUav]]:
    """Two UAVs whose routes cross and are kept apart by a delay; the one that departs first comes first."""
    here, uavs = world(), fleet("Tern", "Kite")
    mission = dispatched(person, uavs, here.towers[4:6])
    carry(*uavs)
    places = list(mission.mission_uavs.select_related("uav", "route").order_by("route__departs_s"))
    assert places[1].route.departs_s - places[0].route.departs_s > 20.0
    return mission, places


def start(place: MissionUav, person: User) -> UavCommand:
    return command_uav(uav=place.uav, kind=CommandKind.START, actor=person)


def took_off(place: MissionUav, ago_s: float) -> None:
    carry(place.uav)
    UavCommand.objects.filter(uav=place.uav, kind=CommandKind.START).update(finished_at=timezone.now() - timedelta(seconds=ago_s))


def test_one_that_was_planned_later_is_not_started_six_seconds_after_the_first(crossing, person) -> None:
    _, (first, second) = crossing
    start(first, person)
    took_off(first, ago_s=6.0)
    with pytest.raises(Refused) as error:
        start(second, person)
    (reason,) = error.value.reasons
    assert (reason.code, reason.uav) == ("start_slot", second.sequence)
    assert first.name in reason.message and "It can be started in" in reason.message
    assert not UavCommand.objects.filter(uav=second.uav, kind=CommandKind.START).exists()


def test_who_answers_for_it_starts_it_all_the_same(crossing, person) -> None:
    _, (first, second) = crossing
    start(first, person)
    took_off(first, ago_s=6.0)
    client, path = client_of(person), f"uavs/{second.uav_id}/commands"
    asked = post(client, path, {"kind": "start"})
    assert (asked.status_code, asked.json()["error"]["code"]) == (409, "start_slot")
    assert post(client, path, {"kind": "start", "parameters": {"out_of_slot": False}}).status_code == 409
    reported = post(client, path, {"kind": "start", "parameters": {"out_of_slot": True}})
    assert (reported.status_code, reported.json()["parameters"]) == (201, {"out_of_slot": True, "flight": 1})
    assert reasons_to_carry_later(UavCommand.objects.get(pk=reported.json()["id"])) == []
    assert post(client, path, {"kind": "hold", "parameters": {"out_of_slot": True}}).json()["error"]["code"] == "no_parameters"


def test_one_that_goes_on_in_the_air_waits_for_nobody(crossing, person) -> None:
    _, (first, second) = crossing
    start(first, person)
    took_off(first, ago_s=6.0)
    Route.objects.filter(mission_uav=second).update(begun_by=2)
    second.route.refresh_from_db()
    assert reasons_to_wait(uav=second.uav, route=second.route, flight=1, now=timezone.now()) == []


@pytest.mark.parametrize("is_in_air", [True, False])
@pytest.mark.parametrize("reported", ["hold", "expired", "aborted"])
def test_one_that_is_not_where_its_plan_has_it_is_waited_for_while_it_is_in_the_air(
    crossing, person, reported: str, is_in_air: bool
) -> None:
    _, (first, second) = crossing
    start(first, person)
    took_off(first, ago_s=1_000.0)
    UavLink.objects.update_or_create(uav=first.uav, defaults={"is_in_air": is_in_air, "last_message_at": timezone.now()})
    if reported == "hold":
        hold = command_uav(uav=first.uav, kind=CommandKind.HOLD, actor=person)
        UavCommand.objects.filter(pk=hold.pk).update(state="applied", sent_at=timezone.now(), finished_at=timezone.now())
    elif reported == "expired":
        UavCommand.objects.filter(uav=first.uav, kind=CommandKind.START).update(state="expired", outcome_code="unconfirmed")
    else:
        first.route.has_failed = True
        first.route.save()
    reasons = reasons_to_wait(uav=second.uav, route=second.route, flight=1, now=timezone.now())
    assert [reason.code for reason in reasons] == (["start_slot"] if is_in_air else [])
    assert all("not at the times of its plan" in reason.message for reason in reasons)


@pytest.mark.parametrize("place", ["near", "far", "untold", "on the ground"])
def test_one_that_is_flown_by_hand_near_the_route_is_waited_for(crossing, person, place: str) -> None:
    _, (first, _second) = crossing
    (free,) = fleet("Gull")
    UavLink.objects.create(uav=free, is_in_air=place != "on the ground", last_message_at=timezone.now())
    if place != "untold":
        position = [UAV_AT.lon + (1.0 if place == "far" else 0.0), UAV_AT.lat]
        reported = {"measured_at": time_text(timezone.now()), "position": position}
        UavWatch.objects.create(uav=free, organisation_id=free.organisation_id, measured={"position": reported})
    reasons = reasons_to_wait(uav=first.uav, route=first.route, flight=1, now=timezone.now())
    assert [reason.code for reason in reasons] == (["start_slot"] if place in ("near", "untold") else [])
    assert all("Gull is in the air without a flight of a mission" in reason.message for reason in reasons)


@pytest.mark.parametrize("is_simulated", [True, False])
def test_a_simulated_uav_that_was_retired_in_the_air_is_in_nobodys_way(crossing, person, is_simulated: bool) -> None:
    _, (first, _second) = crossing
    (gone,) = fleet("Gull", is_simulated=is_simulated, state=UavState.RETIRED)
    UavLink.objects.create(uav=gone, is_in_air=True, last_message_at=timezone.now())
    reasons = reasons_to_wait(uav=first.uav, route=first.route, flight=1, now=timezone.now())
    assert [reason.code for reason in reasons] == ([] if is_simulated else ["start_slot"])


def test_a_start_that_was_sent_is_not_taken_back_for_its_slot(crossing, person) -> None:
    _, (first, second) = crossing
    late = start(second, person)
    UavCommand.objects.filter(pk=late.pk).update(sent_at=timezone.now())
    late.refresh_from_db()
    with pytest.raises(Refused):
        start(first, person)
    assert reasons_to_carry_later(late) == []


def test_a_companion_that_fetches_its_start_late_is_not_given_it(crossing, person) -> None:
    _, (first, second) = crossing
    Uav.objects.filter(pk=second.uav_id).update(link="http")
    second.uav.refresh_from_db()
    late = start(second, person)
    UavCommand.objects.filter(pk=late.pk).update(created_at=timezone.now() - timedelta(seconds=20), state="expired")
    start(first, person)
    took_off(first, ago_s=3.0)
    UavCommand.objects.filter(pk=late.pk).update(state="queued")
    handed = handed_to(second.uav_id, given_to(second.uav_id))
    late.refresh_from_db()
    assert (late.state, late.outcome_code, handed.has_unclaimed) == ("failed", "start-slot", False)


def test_it_is_started_at_its_time(crossing, person) -> None:
    _, (first, second) = crossing
    start(first, person)
    took_off(first, ago_s=second.route.departs_s - first.route.departs_s)
    assert start(second, person)


def test_one_that_is_about_to_take_off_counts_as_taking_off_now(crossing, person) -> None:
    _, (first, second) = crossing
    start(first, person)
    with pytest.raises(Refused) as error:
        start(second, person)
    assert error.value.reasons[0].code == "start_slot"


def test_one_that_is_down_is_in_nobodys_way(crossing, person) -> None:
    mission, (first, second) = crossing
    start(first, person)
    took_off(first, ago_s=6.0)
    mark_flight_ended(mission_id=mission.pk, uav_id=first.uav_id, flight=1, end=FlightEnd.FAILED)
    assert start(second, person)


def test_a_start_that_waited_for_its_link_is_looked_at_again_before_it_is_carried_out(crossing, person) -> None:
    _, (first, second) = crossing
    late = start(second, person)
    assert reasons_to_carry_later(late) == []
    UavCommand.objects.filter(pk=late.pk).update(created_at=timezone.now() - timedelta(seconds=20))
    with pytest.raises(Refused):
        start(first, person)
    UavCommand.objects.filter(pk=late.pk).update(state="expired")
    start(first, person)
    took_off(first, ago_s=3.0)
    UavCommand.objects.filter(pk=late.pk).update(state="queued")
    late.refresh_from_db()
    assert [reason.code for reason in reasons_to_carry_later(late)] == ["start_slot"]


def test_routes_that_share_no_place_start_together(crossing, person) -> None:
    _, (first, second) = crossing
    for waypoint in Route.objects.get(mission_uav=second).waypoints.all():
        waypoint.position.x += 1.0
        waypoint.save()
    start(first, person)
    took_off(first, ago_s=6.0)
    assert start(second, person)
