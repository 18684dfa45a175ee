"""What is left of a mission that flies is planned anew, offered, and changes nothing until somebody takes it."""

from datetime import timedelta

import pytest
from django.utils.dateparse import parse_datetime
from django.utils.translation import override

from missions.models import CommandKind, Mission, MissionState, OfferState, ReplanOffer, TargetState, Uav
from missions.serializers.replan_offers import offer_json
from missions.services.commands.commands import note_applied, note_failed, note_sent
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended
from missions.services.commands.refused import Refused
from missions.services.commands.route_swap import stuck_hand_overs
from missions.services.commands.steering import mission_in_hand
from missions.services.replanning import accept_offer, decline_offer, offers, settle_offers, suggest
from missions.services.replanning.staleness import MIN_LEFT_S, VALID_FOR
from operation.reasons import Reason
from simulation.services.idle_twins import end_copy
from tests.accounts.users import a_user
from tests.missions.commands.outbox import claim, fence, give
from tests.missions.flights import carry, ground
from tests.missions.replanning.in_flight import Flight, two_in_the_air, worked_out
from workspace.models import Job

pytestmark = pytest.mark.django_db


@pytest.fixture
def flight(tmp_path) -> Flight:
    ground(tmp_path / "hill.tif", 100.0)
    return two_in_the_air(a_user())


def test_what_a_uav_that_failed_leaves_is_offered_to_the_other(flight):
    first, second = flight.targets(0), flight.targets(1)
    assert first and second
    mark_flight_ended(mission_id=flight.mission.pk, uav_id=flight.uavs[0].pk, flight=1, end=FlightEnd.FAILED)
    offer = flight.offer()
    assert offer.state == OfferState.OPEN, offer.outcome
    tern, kite = offer.difference["uavs"]
    assert (tern["change"], tern["lost"]) == ("out", first)
    assert (kite["change"], kite["kept"], sorted(kite["gained"])) == ("changed", second, sorted(first))
    assert kite["order"][: len(second)] == second, "what it had to do it does first, in its order"
    assert kite["after"]["length_m"] > kite["before"]["length_m"]
    assert offer.difference["unreached"] == 0
    moved = {entry["target"]: (entry["from"], entry["to"]) for entry in offer.difference["targets"]}
    assert moved == dict.fromkeys(first, (0, 1))
    assert offer.continuation.state == MissionState.PLANNED
    assert offer.continuation.continues_id == flight.mission.pk
    assert not flight.mission.commands.filter(kind=CommandKind.HOLD).exists()


def as_simulated_copy(flight: Flight) -> Mission:
    """Make the flying mission a copy that simulated twins fly, and return the mission that it is a copy of."""
    original = Mission.objects.create(organisation=flight.mission.organisation, author=flight.author, name="Real")
    for uav in flight.uavs:
        real = Uav.objects.create(organisation=uav.organisation, name=f"Real {uav.name}", uav_type=uav.uav_type, location=uav.location)
        Uav.objects.filter(pk=uav.pk).update(is_simulated=True, twin_of=real)
    Mission.objects.filter(pk=flight.mission.pk).update(simulates=original)
    return original


def test_in_a_simulated_copy_the_other_twin_goes_on_in_a_simulated_mission(flight):
    original = as_simulated_copy(flight)
    offer = accept_offer(offer=failed_tern(flight), actor=flight.author)
    continuation = Mission.objects.get(pk=offer.continuation_id)
    assert (continuation.state, continuation.simulates) == (MissionState.DISPATCHED, original)
    end_copy(Mission.objects.get(pk=flight.mission.pk))
    continuation.refresh_from_db()
    assert continuation.state == MissionState.ABORTED
    assert not claim(*flight.uavs), "nothing is sent to twins that are gone"


def test_a_route_is_not_left_amid_photos_beside_wires(flight):
    mark_flight_ended(mission_id=flight.mission.pk, uav_id=flight.uavs[0].pk, flight=1, end=FlightEnd.FAILED)
    flight.fly_to(1, 2, 0.5)
    view = {"yaw_deg": 90.0, "pitch_deg": 0.0, "distance_m": 20.0, "focal_length_mm": 21.0, "clearance_m": 9.0, "heading_deg": None}
    waypoints = flight.route(1).waypoints
    taken = {"target": waypoints.get(sequence=2).target, "task": {"kind": "photo", "hold_s": 3.0, "view": view}}
    waypoints.filter(sequence__in=(1, 2)).update(**taken)
    offer = flight.offer()
    assert "Kite takes photos beside wires" in f"{offer.outcome} {offer.difference}"
    assert offer.continuation is None


def test_a_continued_route_goes_on_from_where_the_uav_flies_and_ends_at_its_home(flight):
    mark_flight_ended(mission_id=flight.mission.pk, uav_id=flight.uavs[0].pk, flight=1, end=FlightEnd.FAILED)
    flight.fly_to(1, 3, 0.5)
    old = flight.route(1)
    offer = flight.offer()
    route = offer.continuation.routes.get()
    rows = list(route.waypoints.order_by("sequence"))
    where = flight.uavs[1].__class__.objects.get(pk=flight.uavs[1].pk).location
    assert rows[0].position.distance(where) < 1e-6
    kept = [row.position.coords for row in old.waypoints.order_by("sequence")[3:]]
    assert [row.position.coords for row in rows[1 : route.begun_by + 1]] == kept[: route.begun_by]
    assert route.begun_by >= 1
    home = old.mission_uav.start
    assert rows[-1].position.distance(home) < 1e-6
    assert route.mission_uav.home.distance(home) < 1e-6
    assert all(row.altitude_relative_m == pytest.approx(row.altitude_amsl_m - 100.0, abs=0.02) for row in rows)


def failed_tern(flight: Flight):
    mark_flight_ended(mission_id=flight.mission.pk, uav_id=flight.uavs[0].pk, flight=1, end=FlightEnd.FAILED)
    return flight.offer()


def test_an_accepted_offer_is_flown_step_by_step(flight):
    first, kite = flight.targets(0), flight.uavs[1]
    offer = accept_offer(offer=failed_tern(flight), actor=flight.author)
    assert offer.state == OfferState.ACCEPTED
    continuation = offer.continuation
    continuation.refresh_from_db()
    assert continuation.state == MissionState.DISPATCHED
    given = []
    for _step in range(3):
        (command,) = carry(kite)
        assert (command.mission_id, command.approval.mission_id) == (continuation.pk, continuation.pk)
        given.append(command.kind)
    assert given == ["hold", "upload-mission", "start"]
    assert not claim(*flight.uavs)
    continuation.refresh_from_db()
    assert continuation.state == MissionState.ACTIVE
    flying = Mission.objects.get(pk=flight.mission.pk)
    assert flying.state == MissionState.FAILED, "a flight of it did fail"
    moved = flying.targets.filter(sequence__in=first)
    assert set(moved.values_list("state", flat=True)) == {TargetState.SKIPPED}
    assert all(continuation.name in reason for reason in moved.values_list("state_reason", flat=True))
    assert mission_in_hand(kite) == continuation


def test_accepted_twice_is_accepted_once(flight):
    offer = failed_tern(flight)
    accept_offer(offer=offer, actor=flight.author)
    accept_offer(offer=offer, actor=flight.author)
    assert flight.uavs[1].commands.filter(kind=CommandKind.HOLD).count() == 1


def test_a_declined_offer_changes_nothing_and_its_mission_is_put_away(flight):
    offer = decline_offer(offer=failed_tern(flight), actor=flight.author)
    assert offer.state == OfferState.DECLINED
    assert Mission.objects.get(pk=offer.continuation_id).deleted_at is not None
    with pytest.raises(Refused):
        accept_offer(offer=offer, actor=flight.author)
    assert not claim(*flight.uavs)


@pytest.mark.parametrize("what", ["command", "age", "place", "target"])
def test_an_offer_from_which_things_have_moved_on_cannot_be_taken(flight, what):
    offer = failed_tern(flight)
    if what == "command":
        give(flight.uavs[1], CommandKind.PAUSE)
    elif what == "age":
        offer.difference["valid_until"] = "2020-01-01T00:00:00Z"
        offer.save()
    elif what == "place":
        flight.fly_to(1, flight.route(1).waypoints.count() - 2, 0.9)
    else:
        flight.mission.targets.filter(sequence=flight.targets(0)[0]).update(state=TargetState.COMPLETE)
    with pytest.raises(Refused) as refused:
        accept_offer(offer=offer, actor=flight.author)
    assert refused.value.reasons[0].code == "outdated"
    assert settle_offers() == 1
    offer.refresh_from_db()
    assert (offer.state, bool(offer.outcome)) == (OfferState.OUTDATED, True)
    again = flight.mission.replan_offers.get(state=OfferState.COMPUTING)
    assert (again.code, again.cause) == (offer.code, offer.cause), "it is worked out again for the same cause"
    assert not flight.uavs[1].commands.filter(kind=CommandKind.HOLD).exists()
    assert not flight.mission.routes.filter(continued_by__isnull=False).exists()


def test_an_offer_ends_when_a_uav_comes_too_near_to_where_it_leaves_its_route(flight):
    offer = failed_tern(flight)
    until = parse_datetime(offer.difference["valid_until"])
    assert until is not None
    route = offer.continuation.routes.get()
    points = list(route.waypoints.order_by("sequence")[: route.begun_by + 1])
    kite = Uav.objects.get(pk=flight.uavs[1].pk)
    left_s = points[-1].arrival_s - points[0].arrival_s - MIN_LEFT_S
    expected = min(kite.located_at + timedelta(seconds=left_s), offer.created_at + VALID_FOR)
    assert abs((until - expected).total_seconds()) < 2.0
    Uav.objects.filter(pk=kite.pk).update(located_at=until)
    assert settle_offers(now=until - timedelta(seconds=1)) == 0
    assert settle_offers(now=until + timedelta(seconds=1)) == 1


@pytest.mark.long
def test_an_offer_is_not_worked_out_again_once_the_mission_has_ended_or_was_offered_too_often(flight, monkeypatch):
    offer = failed_tern(flight)
    monkeypatch.setattr(offers, "MAX_OFFERS_OF_CAUSE", 1)
    assert settle_offers(now=offer.created_at + timedelta(hours=1)) == 1
    assert not flight.mission.replan_offers.filter(state=OfferState.COMPUTING).exists()
    monkeypatch.undo()
    offer = flight.offer()
    Mission.objects.filter(pk=flight.mission.pk).update(state=MissionState.ABORTED)
    assert settle_offers() == 1
    assert not flight.mission.replan_offers.filter(state=OfferState.COMPUTING).exists()


@pytest.mark.long
def test_a_step_that_fails_is_the_last(flight):
    accept_offer(offer=failed_tern(flight), actor=flight.author)
    carry(flight.uavs[1])
    (upload,) = claim(flight.uavs[1])
    assert note_sent(upload.pk, **fence(upload))
    assert note_failed(upload.pk, "refused", "The vehicle has no room.", **fence(upload))
    assert [command.pk for command in stuck_hand_overs()] == [upload.pk]
    assert not claim(*flight.uavs)
    give(flight.uavs[1], CommandKind.RETURN)
    assert not stuck_hand_overs()


def test_whoever_commands_the_uav_meanwhile_has_the_last_word(flight):
    accept_offer(offer=failed_tern(flight), actor=flight.author)
    carry(flight.uavs[1])
    (upload,) = claim(flight.uavs[1])
    give(flight.uavs[1], CommandKind.RETURN)
    assert note_sent(upload.pk, **fence(upload))
    assert note_applied(upload.pk, **fence(upload))
    assert [command.kind for command in claim(*flight.uavs)] == ["return"]


def test_why_an_offer_is_outdated_is_read_in_german(flight):
    offer = suggest(mission_id=flight.mission.pk, code="asked-for", cause={})
    why = [Reason("other_command_since", {"uav": "Tern"}), Reason("asked_for_again")]
    offers.end_offer(offers.held_offer(offer), OfferState.OUTDATED, why)
    offer.refresh_from_db()
    assert offer.outcome == "Tern was given another command since.\nIt was asked for again."
    with override("de"):
        shown = offer_json(offer)
    assert shown["outcome"].splitlines()[1] == "Es wurde neu danach gefragt."
    assert [reason["code"] for reason in shown["outcome_why"]] == ["other_command_since", "asked_for_again"]


def test_one_cause_is_suggested_once(flight):
    cause = {"uav": flight.uavs[0].pk, "silent_s": 31.0}
    offer = suggest(mission_id=flight.mission.pk, code="uav-out", cause=cause)
    assert offer is not None
    assert suggest(mission_id=flight.mission.pk, code="uav-out", cause=cause | {"silent_s": 40.0}) is None
    worked = worked_out(offer, Job.objects.get(parameters__offer=str(offer.pk)))
    assert worked.state == OfferState.OPEN, worked.outcome
    decline_offer(offer=worked, actor=flight.author)
    assert suggest(mission_id=flight.mission.pk, code="uav-out", cause=cause) is None
    assert suggest(mission_id=flight.mission.pk, code="battery-short", cause=cause) is not None


def test_a_uav_that_dropped_out_is_told_to_return_when_others_take_over(flight):
    tern = flight.uavs[0]
    offer = suggest(mission_id=flight.mission.pk, code="uav-out", cause={"uav": tern.pk})
    worked_out(offer, Job.objects.get(parameters__offer=str(offer.pk)))
    accept_offer(offer=ReplanOffer.objects.get(pk=offer.pk), actor=flight.author)
    assert [command.kind for command in claim(tern)] == ["return"]
    flying = Mission.objects.get(pk=flight.mission.pk)
    assert flying.state == MissionState.ABORTED
    assert not flying.targets.filter(state__in=["pending", "in-progress"]).exists()
