"""Regions on several continents in one installation: every page opens where its user worked last."""

import re

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import Site, Visitor

pytestmark = [pytest.mark.browser, pytest.mark.long]
PLACES = {"Columbus": (-83.0, 40.0), "Pokhara": (84.0, 28.2)}
MADE = f"""
from django.contrib.gis.geos import Point, Polygon
from inspection.models import Asset, DataImport, Region
from inspection.services.ground import mark_ground_changed
for number, (name, (lon, lat)) in enumerate({PLACES!r}.items()):
    region = Region.objects.create(name=name, extent=Polygon.from_bbox((lon - 0.1, lat - 0.1, lon + 0.1, lat + 0.1)))
    source = DataImport.objects.create(kind="osm", file_name=name, sha256=name, region=region)
    for step in range(5):
        point = Point(lon + step * 0.01, lat, srid=4326)
        Asset.objects.create(kind="tower", subtype="tower", geometry=point, centre=point, osm_type="n",
                             osm_id=9_000_000_000 + 10 * number + step, data_import=source)
mark_ground_changed()
"""
GONE = f"""
from inspection.models import Asset, DataImport, Region
from inspection.services.ground import mark_ground_changed
Asset.objects.filter(data_import__region__name__in={list(PLACES)!r}).delete()
DataImport.objects.filter(region__name__in={list(PLACES)!r}).delete()
Region.objects.filter(name__in={list(PLACES)!r}).delete()
mark_ground_changed()
"""
PAGES = ("/missions/new", "/live", "/assets", "/zones", "/uavs")


def test_every_page_with_a_map_opens_in_the_region_where_its_user_worked_last(visitor: Visitor, site: Site) -> None:
    site.does(MADE)
    try:
        page = visitor.signs_in("cora", "/assets")
        for name in PLACES:
            page.locator("#open-regions").click()
            with page.expect_response(lambda answer: answer.url.endswith("/account/map-view")):
                page.get_by_role("button", name=re.compile(name)).first.click()
            for path in PAGES:
                page.goto(path)
                expect(page.locator("#open-regions")).to_contain_text(name)
            page.goto("/assets")
            expect(page.locator("#open-regions")).to_contain_text(name)
    finally:
        site.does(GONE)
