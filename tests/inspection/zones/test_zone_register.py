"""The register of zones: filters, orders, counts, files, and whether a zone applies now or next."""

import csv
import json
import sqlite3
from datetime import UTC, datetime, timedelta
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from django.test import Client

from inspection.models import NoFlyZone, ZoneSet
from inspection.selectors.register.zones import activity_of
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import zone
from workspace.models import Role

BOX = (12.5, 55.6, 12.6, 55.7)
MONDAY = datetime(2026, 11, 23, tzinfo=UTC)
WORKING_HOURS = [
    {
        "startDateTime": None,
        "endDateTime": None,
        "schedule": [{"day": ["MON"], "startTime": "08:00:00Z", "startEvent": None, "endTime": "18:00:00Z", "endEvent": None}],
    }
]


@pytest.fixture
def client(db: None) -> Client:
    return client_of(a_user(Role.VIEWER))


def ids(client: Client, query: str) -> list[int]:
    answer = client.get(f"/api/v1/zones?{query}")
    assert answer.status_code == 200, answer.content
    return [feature["id"] for feature in answer.json()["features"]]


@pytest.mark.parametrize(
    ("hour", "is_active", "changes_at"),
    [
        (7, False, MONDAY.replace(hour=8)),
        (8, True, MONDAY.replace(hour=18)),
        (17, True, MONDAY.replace(hour=18)),
        (18, False, MONDAY.replace(hour=8) + timedelta(days=7)),
    ],
)
def test_a_zone_tells_whether_it_applies_and_when_this_changes(hour: int, is_active: bool, changes_at: datetime) -> None:
    found = activity_of(WORKING_HOURS, BOX, MONDAY.replace(hour=hour))
    assert (found.is_active, found.changes_at) == (is_active, changes_at)


def test_a_zone_without_a_schedule_always_applies_and_one_that_is_over_never() -> None:
    assert activity_of(None, BOX, MONDAY) == activity_of([], BOX, MONDAY)
    always = activity_of(None, BOX, MONDAY)
    assert (always.is_active, always.changes_at) == (True, None)
    over = [{"startDateTime": None, "endDateTime": "2026-01-01T00:00:00Z", "schedule": []}]
    never = activity_of(over, BOX, MONDAY)
    assert (never.is_active, never.changes_at) == (False, None)


def three(client: Client) -> tuple[NoFlyZone, NoFlyZone, NoFlyZone]:
    own = ZoneSet.objects.create(name="Switzerland")
    return (
        zone(
            name="airport", restriction="PROHIBITED", reason="AIR_TRAFFIC, NOISE", upper_limit_m=300.0, upper_reference="AMSL", zone_set=own
        ),
        zone(
            name="Bird park", restriction="CONDITIONAL", reason="NATURE", upper_limit_m=120.0, upper_reference="AGL", schedule=WORKING_HOURS
        ),
        zone(name="Camp"),
    )


def test_zones_are_found_by_restriction_reason_and_time(client: Client) -> None:
    airport, birds, camp = three(client)
    assert ids(client, "restriction=PROHIBITED") == [airport.pk]
    assert ids(client, "restriction=not_stated") == [camp.pk]
    assert ids(client, "reason=NOISE") == [airport.pk]
    assert ids(client, "reason=NOI") == []
    assert ids(client, "reason=not_stated") == [camp.pk]
    assert ids(client, "active_at=2026-11-23T09:00:00Z") == [airport.pk, birds.pk, camp.pk]
    assert ids(client, "active_at=2026-11-23T19:00:00Z") == [airport.pk, camp.pk]


@pytest.mark.parametrize("order", ["name", "restriction", "reason", "lower", "upper", "set", "changed"])
def test_every_order_pages_through_all_zones_in_both_directions(client: Client, order: str) -> None:
    three(client)
    whole = ids(client, f"sort={order}")
    assert sorted(whole) == sorted(NoFlyZone.objects.values_list("pk", flat=True))
    assert ids(client, f"sort=-{order}") == whole[::-1]
    first = client.get(f"/api/v1/zones?sort={order}&limit=2").json()
    rest = client.get(first["next"]).json()
    assert [row["id"] for row in first["features"] + rest["features"]] == whole


def test_limits_that_are_not_stated_come_last(client: Client) -> None:
    airport, birds, camp = three(client)
    assert ids(client, "sort=upper") == [birds.pk, airport.pk, camp.pk]


def test_counts_of_a_fact_disregard_the_filter_by_it(client: Client) -> None:
    airport, _birds, _camp = three(client)
    found = client.get("/api/v1/zones/summary?restriction=PROHIBITED").json()
    assert found["total"] == 1
    assert {row["value"]: row["count"] for row in found["restrictions"]} == {"PROHIBITED": 1, "CONDITIONAL": 1, "": 1}
    assert {row["value"]: row["count"] for row in found["reasons"]} == {"AIR_TRAFFIC": 1, "NOISE": 1}
    assert found["zone_sets"] == [{"zone_set": airport.zone_set_id, "name": "Switzerland", "count": 1}]
    assert client.get(f"/api/v1/zones/summary?zone_set={airport.zone_set_id}&reason=not_stated").json()["total"] == 0


@pytest.mark.parametrize("query", ["sort=colour", "active_at=then", "zone_set=x", f"reason={'x' * 256}"])
def test_a_filter_that_makes_no_sense_is_refused(client: Client, query: str) -> None:
    assert client.get(f"/api/v1/zones?{query}").status_code == 400


def content(answer: Any) -> bytes:
    return b"".join(answer.streaming_content)


def test_files_have_what_is_filtered(client: Client, tmp_path: Path) -> None:
    airport, _birds, _camp = three(client)
    table = list(csv.DictReader(StringIO(content(client.get("/api/v1/zones/export.csv?reason=NOISE")).decode())))
    assert [(row["name"], row["upper_limit_m"], row["upper_reference"], row["zone_set"]) for row in table] == [
        ("airport", "300.0", "AMSL", "Switzerland")
    ]
    (feature,) = json.loads(content(client.get("/api/v1/zones/export.geojson?reason=NOISE")))["features"]
    assert (feature["id"], feature["geometry"]["type"]) == (airport.pk, "MultiPolygon")
    path = tmp_path / "zones.gpkg"
    path.write_bytes(content(client.get("/api/v1/zones/export.gpkg")))
    database = sqlite3.connect(path)
    assert database.execute("SELECT count(*) FROM zones").fetchone() == (3,)
    database.close()
    assert client.get("/api/v1/zones/export.csv?reason=PRIVACY").json()["error"]["code"] == "nothing_found"
