"""The region that an upload is put into: the user's choice, which its place decides otherwise."""

from typing import Any

import pytest
from django.test import Client

from inspection.models import DataImport, NoFlyZone, Region
from inspection.services.imports.regions import join_region
from tests.inspection.ground import tower
from tests.inspection.imports.test_imports_api import apply, propose, read, zone_file

pytestmark = pytest.mark.django_db


def an_import(name: str, place: tuple[float, float], **facts: Any) -> Region:
    data_import = DataImport.objects.create(kind="osm", file_name=f"{name}.osm.pbf", sha256=name, **facts)
    tower((place[0] - 0.1, place[1] - 0.1), data_import=data_import)
    tower((place[0] + 0.1, place[1] + 0.1), data_import=data_import)
    region = join_region(data_import)
    assert region is not None
    return region


def region_of_zones() -> str:
    found = DataImport.objects.get(kind="zones").region
    assert found is not None
    return found.name


def put(client: Client, **parameters: Any) -> None:
    apply(client, read(client, propose(client, zone_file(("A", 9.0)), **parameters)))


def test_the_place_decides_without_a_choice(client: Client) -> None:
    an_import("jura", (9.05, 47.05))
    put(client, region="")
    assert region_of_zones() == "Jura"


def test_an_upload_joins_the_region_that_its_user_names(client: Client) -> None:
    an_import("jura", (9.05, 47.05))
    extent = an_import("ohio", (-83.0, 40.0)).extent.extent
    put(client, region="Ohio")
    assert region_of_zones() == "Ohio"
    assert Region.objects.get(name="Ohio").extent.extent == extent


def test_a_new_name_makes_a_region_and_leaves_none_without_data(client: Client) -> None:
    put(client, region="  Alps North ")
    assert [row.name for row in Region.objects.all()] == ["Alps North"]
    assert NoFlyZone.objects.count() == 1


def test_the_choice_at_the_review_counts_and_reads_nothing_again(client: Client) -> None:
    ready = read(client, propose(client, zone_file(("A", 9.0))))
    assert apply(client, ready, region="Alps")["state"] == "applied"
    assert region_of_zones() == "Alps"


@pytest.mark.parametrize("name", ["Elme Valley", "x" * 201, 7, "a\nb"])
def test_a_region_that_cannot_be_is_refused(client: Client, name: Any) -> None:
    an_import("demo", (9.05, 47.05), is_synthetic=True)
    body = {"kind": "zones", "upload": "5f0c9b0e-0000-4000-8000-000000000000", "parameters": {"region": name}}
    answer = client.post("/api/v1/imports", body, content_type="application/json")
    assert answer.status_code == 400
    assert "region" in str(answer.json()["error"]["details"])
