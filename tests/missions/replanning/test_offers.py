"""What is left of a mission that flies is planned anew, offered, and changes nothing until somebody takes it."""

import pytest

from missions.models import CommandKind, MissionState, OfferState
from missions.services.flying import FlightEnd, mark_flight_ended
from tests.missions.flights import ground
from tests.missions.replanning.in_flight import Flight, two_in_the_air
from tests.workspace.people import somebody

pytestmark = pytest.mark.django_db


@pytest.fixture
def flight(tmp_path) -> Flight:
    ground(tmp_path / "hill.tif", 100.0)
    return two_in_the_air(somebody())


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
