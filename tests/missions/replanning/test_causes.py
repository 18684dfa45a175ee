"""Why the rest of a mission is planned anew: a zone across a route, a battery that does not last; and when that is not possible."""

from datetime import timedelta
from typing import Any

import numpy as np
import pytest
import shapely
from celery.exceptions import SoftTimeLimitExceeded
from django.utils import timezone
from shapely.geometry import LineString

from inspection.models import NoFlyZone
from inspection.services import mark_ground_changed
from missions import tasks
from missions.models import CommandKind, OfferState, ReplanOffer
from missions.services.replanning import accept_offer, suggest, suggest_for_zones, zones_ahead
from tests.accounts.users import a_user, client_of
from tests.missions import worlds
from tests.missions.commands.outbox import give
from tests.missions.flights import carry, ground
from tests.missions.replanning.in_flight import Flight, two_in_the_air, worked_out
from workspace.models import Job

pytestmark = pytest.mark.django_db


@pytest.fixture
def flight(tmp_path) -> Flight:
    ground(tmp_path / "hill.tif", 100.0)
    return two_in_the_air(a_user())


def job_of(offer: ReplanOffer) -> Job:
    return Job.objects.get(parameters__offer=str(offer.pk))


def middle_of_last_visits(flight: Flight, place: int) -> tuple[float, float]:
    """Between the last two targets of a route."""
    rows = list(flight.route(place).waypoints.filter(kind="target").order_by("sequence"))[-2:]
    lon, lat = np.mean([row.position.coords[:2] for row in rows], axis=0)
    return float(lon), float(lat)


@pytest.mark.long
def test_a_worker_that_ends_while_it_looks_for_zones_leaves_them_to_the_next(flight, monkeypatch):
    zone = worlds.zone_around(middle_of_last_visits(flight, 1), half_deg=0.0008)

    def out_of_time(*_: object) -> None:
        raise SoftTimeLimitExceeded

    with monkeypatch.context() as slow, pytest.raises(SoftTimeLimitExceeded):
        slow.setattr(zones_ahead, "zones_met", out_of_time)
        suggest_for_zones()
    (offer,) = suggest_for_zones()
    assert offer.cause["zone"] == zone.pk


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


def marks(flight: Flight) -> list[dict[str, Any]]:
    """What the mission's document says of zones."""
    found = client_of(flight.author).get(f"/api/v1/missions/{flight.mission.pk}").json()
    return [cause for cause in found["stale_causes"] if cause["what"] == "zone"]


def test_a_mission_that_flies_is_marked_at_once_with_the_leg_that_is_still_flown(flight):
    assert marks(flight) == []
    zone = worlds.zone_around(middle_of_last_visits(flight, 1), half_deg=0.0008, name="Air show", with_graph=False)
    reported = {tuple(mark["leg"]) for mark in marks(flight)}
    visits = flight.route(1).waypoints.filter(kind="target").count()
    leg = (f"B{visits - 1}", f"B{visits}")
    assert leg in reported
    assert all(mark["uav"] == 1 and "Air show touches" in mark["message"] for mark in marks(flight))
    tasks.look_after_offers()
    offer = ReplanOffer.objects.get()
    assert (offer.cause["zone"], offer.cause["zone_name"], offer.cause["uav_name"]) == (zone.pk, "Air show", flight.uavs[1].name)
    assert tuple(offer.cause["leg"]) in reported
    page = client_of(flight.author).get("/api/v1/missions").json()["results"]
    assert [mission["is_stale"] for mission in page if mission["id"] == str(flight.mission.pk)] == [True]


@pytest.mark.long
def test_a_leg_that_a_uav_has_behind_it_is_not_marked(flight):
    rows = list(flight.route(1).waypoints.order_by("sequence"))
    targets = [place for place, row in enumerate(rows) if row.kind == "target"]
    between = np.mean([rows[place].position.coords[:2] for place in targets[:2]], axis=0)
    worlds.zone_around(tuple(between.tolist()), half_deg=0.0004, name="Air show", with_graph=False)
    assert ["B1", "B2"] in [mark["leg"] for mark in marks(flight)]
    flight.fly_to(1, targets[-1], 0.5)
    assert ["B1", "B2"] not in [mark["leg"] for mark in marks(flight)]


def test_of_a_flying_mission_the_time_counts_at_which_its_uavs_come_there(flight):
    """A zone that begins in two hours, and one that has begun."""
    zone = worlds.zone_around(middle_of_last_visits(flight, 1), half_deg=0.0008, name="Air show", with_graph=False)
    for begins, is_met in ((timedelta(hours=2), False), (-timedelta(minutes=5), True)):
        period = {"startDateTime": f"{timezone.now() + begins:%Y-%m-%dT%H:%M:%SZ}", "endDateTime": None, "schedule": []}
        NoFlyZone.objects.filter(pk=zone.pk).update(schedule=[period])
        mark_ground_changed()
        assert bool(marks(flight)) is is_met


@pytest.mark.long
def test_a_zone_far_from_what_is_left_is_no_reason(flight):
    worlds.zone_around((10.5, 56.5))
    assert suggest_for_zones() == []
    offer = flight.offer()
    assert offer.state == OfferState.IMPOSSIBLE
    assert "Nothing would change" in offer.outcome


@pytest.mark.long
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
    flight = two_in_the_air(a_user(), battery_wh=150.0)
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
