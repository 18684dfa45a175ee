"""The page of the fleet tells how UAVs are connected, and an administrator says whose unknown vehicles are."""

import json
import urllib.request
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Site, Visitor
from tests.browser.operator_map import asks, unlimited_type
from tests.browser.regions import region
from tests.browser.test_accessibility import faults
from tests.browser.test_fleet import Picture, details, fleet, writes

pytestmark = pytest.mark.browser

YARD = region.at(0.01, 0.01)
RECEIVED = f"""
from django.contrib.gis.geos import Point
from django.utils import timezone
from telemetry.models import UnknownVehicle
for system_id, place in ((41, Point({YARD[0]}, {YARD[1]})), (42, None)):
    UnknownVehicle.objects.create(
        mavlink_system_id=system_id, autopilot="ardupilot", vehicle_type="Quadrotor", address="udp 10.0.0.7:14550", location=place,
        last_message_at=timezone.now(),
    )
"""


def unknown(page: Page) -> Any:
    return page.locator("#fleet-unknown")


def reports(site: Site, token: str, **record: Any) -> None:
    """As the UAV itself."""
    body = json.dumps({"stream": "boot-1", "records": [record]}).encode()
    headers = {"Authorization": f"Bearer {token}", "Content-Type": "application/json"}
    request = urllib.request.Request(f"{site.address}/api/v1/uav-link/telemetry", body, headers)  # noqa: S310 - this machine
    with urllib.request.urlopen(request, timeout=20) as answer:  # noqa: S310
        assert json.load(answer)["stored"] == 1


@pytest.mark.long
def test_a_uav_that_is_heard_over_http_says_so_in_its_panel(site: Site, visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    uav = writes(page, "POST", "/uavs", {"name": "Sandpiper", "position": YARD, "type": unlimited_type(page), "link": "http"})["id"]
    token = writes(page, "POST", f"/uavs/{uav}/credentials", {"kind": "link-token"})["secret"]
    fleet(page, f"?id={uav}")
    expect(details(page).get_by_text("Never connected.")).to_be_visible()
    expect(details(page).get_by_text("a companion computer over HTTP")).to_be_visible()
    measured_at = page.evaluate("new Date().toISOString()")
    reports(site, token, sequence=1, measured_at=measured_at, position=YARD, mode="Mission", is_in_air=True, battery_percent=64.0)
    expect(details(page).get_by_text("s ago over HTTP.")).to_be_visible()
    expect(details(page).get_by_text("Mission, in the air")).to_be_visible()
    assert faults(page) == []
    picture(page, "uav-link-light")


@pytest.mark.long
def test_only_an_administrator_says_that_a_uav_is_simulated_or_needs_no_signature(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    uav = writes(page, "POST", "/uavs", {"name": "Stint", "position": YARD, "type": unlimited_type(page)})["id"]
    fleet(page, f"?id={uav}")
    page.get_by_role("button", name="Edit", exact=True).click()
    switch = page.get_by_role("switch", name="MAVLink without a signature")
    expect(switch).to_be_disabled()
    expect(switch).to_have_accessible_description("Only an administrator changes this.")
    expect(page.locator("#fleet-unknown")).to_be_hidden()
    page = visitor.signs_in("ada")
    fleet(page, f"?id={uav}")
    page.get_by_role("button", name="Edit", exact=True).click()
    page.get_by_role("switch", name="MAVLink without a signature").check()
    page.get_by_role("switch", name="Simulated").check()
    page.get_by_label("Command link").select_option("a companion computer over HTTP")
    assert faults(page) == []
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.get_by_text("Stint is saved.")).to_be_visible()
    facts = asks(page, f"/uavs/{uav}")["properties"]
    assert (facts["allows_unsigned"], facts["is_simulated"], facts["link"]) == (True, True, "http")
    expect(details(page).get_by_text("is taken for its word")).to_be_visible()


def test_an_unknown_vehicle_is_adopted_and_another_ignored(site: Site, visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("ada")
    fleet(page)
    expect(unknown(page).get_by_text("None. Vehicles with an unknown system ID")).to_be_visible()
    site.does(RECEIVED)
    fleet(page)
    expect(unknown(page).get_by_text("System 41")).to_be_visible()
    assert faults(page) == []
    picture(page, "unknown-vehicles-light")
    unknown(page).get_by_role("button", name="Ignore system 42").click()
    expect(unknown(page).get_by_text("System 42")).to_be_hidden()
    page.get_by_role("button", name="Undo").click()
    expect(unknown(page).get_by_text("System 42")).to_be_visible()
    unknown(page).get_by_role("button", name="Ignore system 42").click()
    unknown(page).get_by_role("button", name="Show 1 ignored one").click()
    expect(unknown(page).get_by_role("button", name="List again: system 42")).to_be_visible()

    unknown(page).get_by_role("button", name="Adopt system 41").click()
    expect(unknown(page).get_by_label("It is")).to_be_focused()
    unknown(page).get_by_label("Name").fill("Redshank")
    assert faults(page) == []
    unknown(page).get_by_role("button", name="Adopt", exact=True).click()
    expect(page.get_by_text("System 41 is Redshank now.")).to_be_visible()
    expect(details(page).get_by_role("heading", name="Redshank", exact=True)).to_be_visible()
    (uav,) = asks(page, "/uavs?text=Redshank")["features"]
    assert (uav["properties"]["mavlink_system_id"], uav["geometry"]["coordinates"]) == (41, YARD)
