"""Why the rest of a mission is planned anew: a zone across a route, a battery that does not last; and when that is not possible."""

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString

from inspection.models import NoFlyZone
from missions.models import CommandKind, OfferState, ReplanOffer
from missions.services.replanning import accept_offer, suggest, suggest_for_zones
from tests.missions import worlds
from tests.missions.flights import carry, ground
from tests.missions.outbox import give
from tests.missions.replanning.in_flight import Flight, two_in_the_air, worked_out
from tests.workspace.people import somebody
from workspace.models import Job

pytestmark = pytest.mark.django_db


@pytest.fixture
def flight(tmp_path) -> Flight:
    ground(tmp_path / "hill.tif", 100.0)
    return two_in_the_air(somebody())


def job_of(offer: ReplanOffer) -> Job:
    return Job.objects.get(parameters__offer=str(offer.pk))


def middle_of_last_visits(flight: Flight, place: int) -> tuple[float, float]:
    """Between the last two targets of a route."""
    rows = list(flight.route(place).waypoints.filter(kind="target").order_by("sequence"))[-2:]
    lon, lat = np.mean([row.position.coords[:2] for row in rows], axis=0)
    return float(lon), float(lat)


def test_a_zone_that_comes_across_a_route_is_gone_round(flight):
    assert suggest_for_zones() == []
    zone = worlds.zone_around(middle_of_last_visits(flight, 1), half_deg=0.0008)
    (offer,) = suggest_for_zones()
    assert (offer.code, offer.cause["zone"]) == ("zone-active", zone.pk)
    assert suggest_for_zones() == []
    offer = worked_out(offer, job_of(offer))
    assert offer.state == OfferState.OPEN, offer.outcome
    changed = [uav for uav in offer.difference["uavs"] if uav["change"] == "changed"]
    assert zone.name in changed[0]["why"]
    shape = shapely.from_wkb(bytes(NoFlyZone.objects.get().geometry.wkb))
    for route in offer.continuation.routes.filter(geometry__isnull=False):
        assert not LineString(route.geometry.coords).intersects(shape)


def test_a_zone_far_from_what_is_left_is_no_reason(flight):
    worlds.zone_around((10.5, 56.5))
    assert suggest_for_zones() == []
    offer = flight.offer()
    assert offer.state == OfferState.IMPOSSIBLE
    assert "Nothing would change" in offer.outcome


def test_a_uav_before_whose_nose_the_zone_lies_is_to_be_held_first(flight):
    rows = list(flight.route(0).waypoints.order_by("sequence"))
    first = next(row for row in rows if row.kind == "target")
    flight.fly_to(0, first.sequence, 0.05)
    worlds.zone_around(first.position.coords[:2], half_deg=0.0015)
    (offer,) = suggest_for_zones()
    offer = worked_out(offer, job_of(offer))
    assert offer.state == OfferState.IMPOSSIBLE
    assert "Hold it" in offer.outcome


def test_a_battery_that_does_not_last_gives_its_targets_to_the_other(tmp_path):
    ground(tmp_path / "hill.tif", 100.0)
    flight = two_in_the_air(somebody(), battery_wh=150.0)
    tern = flight.uavs[0]
    flight.fly_to(0, 2, 0.5, battery_percent=25.0)
    flight.fly_to(1, 2, 0.5, battery_percent=95.0)
    offer = suggest(mission_id=flight.mission.pk, code="battery-short", cause={"uav": tern.pk})
    offer = worked_out(offer, job_of(offer))
    assert offer.state == OfferState.OPEN, offer.outcome
    own, other = offer.difference["uavs"]
    assert own["lost"] and set(own["lost"]) <= set(other["gained"])
    assert other["after"]["battery_percent"] >= 20.0
    assert other["after"]["battery_percent"] < other["before"]["battery_percent"]
    if own["after"] is not None:
        assert own["after"]["battery_percent"] >= 20.0


def test_a_uav_that_is_held_is_planned_for_from_where_it_is(flight):
    author = flight.author
    give(flight.uavs[1], CommandKind.HOLD, author)
    carry(flight.uavs[1])
    flight.fly_to(1, 2, 0.5)
    give(flight.uavs[0], CommandKind.RETURN, author)
    carry(flight.uavs[0])
    offer = flight.offer()
    assert offer.state == OfferState.OPEN, offer.outcome
    tern, kite = offer.difference["uavs"]
    assert (tern["change"], kite["change"]) == ("out", "changed")
    assert offer.continuation.routes.get().begun_by == 0
    accept_offer(offer=offer, actor=author)


def test_nobody_is_left_to_take_over(flight):
    for uav in flight.uavs:
        give(uav, CommandKind.RETURN, flight.author)
        carry(uav)
    offer = flight.offer()
    assert offer.state == OfferState.IMPOSSIBLE
    assert offer.outcome
