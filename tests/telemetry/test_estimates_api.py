"""A mission's estimates, page by page, and how good they were."""

from datetime import timedelta
from typing import Any

import pytest
from django.contrib.gis.geos import Point

from missions.models import Mission, Uav
from telemetry.models import PositionEstimate
from telemetry.selectors.estimates import estimate_quality_of
from telemetry.services import retention, store_records
from tests.accounts.users import a_user, client_of
from tests.missions.commands.outbox import a_uav
from tests.telemetry.records import START, at, record
from workspace.models import Organisation, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def mission() -> Mission:
    return Mission.objects.create(name="Bexley")


def estimated(uav: Uav, mission: Mission | None, second: float, **values: Any) -> PositionEstimate:
    bounds = {"bound_along_m": 10.0, "bound_across_m": 5.0, "bound_bearing_deg": 90.0, "bound_height_m": 4.0, "bound_speed_mps": 1.0}
    facts = {"position": Point(10.0, 55.0), "speed_mps": 9.0, "report_at": START} | bounds | values
    return PositionEstimate.objects.create(uav=uav, mission=mission, estimated_for=at(second), **facts)


def listed(mission: Mission, query: str = "", role: Role = Role.VIEWER) -> dict[str, Any]:
    answer = client_of(a_user(role)).get(f"/api/v1/missions/{mission.pk}/estimates?{query}")
    assert answer.status_code == 200, answer.content
    return answer.json()


def test_estimates_are_listed_in_their_order_page_by_page(mission):
    kite, tern = a_uav("Kite"), a_uav("Tern")
    for second in range(4):
        estimated(kite, mission, second)
    estimated(tern, mission, 1.0, replaced_at=at(3))
    estimated(kite, None, 9.0)
    first = listed(mission, "limit=3")
    rest = client_of(a_user(Role.VIEWER)).get(first["next"]).json()
    moments = [feature["properties"]["estimated_for"] for page in (first, rest) for feature in page["features"]]
    assert moments == sorted(moments)
    assert len(moments) == 5
    assert rest["next"] is None
    feature = first["features"][0]
    assert feature["geometry"] == {"type": "Point", "coordinates": [10.0, 55.0]}
    assert feature["properties"]["bound_along_m"] == 10.0
    assert feature["properties"]["replaced_at"] is None


def test_estimates_can_be_chosen_by_uav_time_and_what_became_of_them(mission):
    kite, tern = a_uav("Kite"), a_uav("Tern")
    for second in range(4):
        estimated(kite, mission, second)
    estimated(tern, mission, 1.0, replaced_at=at(3))
    assert len(listed(mission, f"uav={tern.pk}")["features"]) == 1
    assert len(listed(mission, "replaced=true")["features"]) == 1
    assert len(listed(mission, "replaced=false")["features"]) == 4
    assert len(listed(mission, "from=2026-11-22T12:00:01Z&to=2026-11-22T12:00:03Z")["features"]) == 3
    assert client_of(a_user()).get(f"/api/v1/missions/{mission.pk}/estimates?replaced=no").status_code == 400


def test_of_another_organisation_nothing_is_told(mission):
    estimated(a_uav("Kite"), mission, 1.0)
    stranger = a_user(Role.VIEWER, Organisation.objects.create(name="Others"))
    assert client_of(stranger).get(f"/api/v1/missions/{mission.pk}/estimates").status_code == 404


def test_how_good_they_were_is_told_by_what_was_measured(mission):
    kite = a_uav("Kite")
    moved = [record(kite, number, longitude_deg=10.0 + number * 1e-4, mission_item=None) for number in range(4)]
    store_records(moved)
    kite.records.update(mission=mission)
    estimated(kite, mission, 1.5, position=Point(10.00015, 55.0))
    estimated(kite, mission, 2.0, position=Point(10.0002, 55.0001))
    estimated(kite, mission, 500.0)
    quality = estimate_quality_of(mission.pk)
    assert (quality.whole.count, quality.untold) == (2, 1)
    assert quality.whole.largest_m == pytest.approx(11.1, abs=0.1)
    assert quality.whole.inside_share == 0.5


def test_they_are_forgotten_with_the_records(mission, settings):
    settings.TELEMETRY_DAYS = 30
    kite = a_uav("Kite")
    old, new = estimated(kite, mission, 0.0), estimated(kite, mission, 1.0)
    PositionEstimate.objects.filter(pk=new.pk).update(estimated_for=retention.timezone.now() - timedelta(days=29))
    PositionEstimate.objects.filter(pk=old.pk).update(estimated_for=retention.timezone.now() - timedelta(days=31))
    retention.forget_old_telemetry()
    assert list(PositionEstimate.objects.values_list("pk", flat=True)) == [new.pk]
