"""A mission of real UAVs is flown in simulation by one click: a copy of it, on a page that says so and leads back."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import TOO_WIDE, asks
from tests.browser.pictures import Picture
from tests.browser.simulated_mission import (
    FLIGHT_MS,
    SOON_MS,
    answers,
    card,
    opened,
    panel_of,
    simulated_uavs,
    stores_simulated_mission,
    two_towers,
)
from tests.browser.test_accessibility import faults
from tests.browser.test_fleet import writes

pytestmark = pytest.mark.browser

NAME = "Nightjar"
TWIN = f"{NAME} (simulated)"


@pytest.fixture
def mission(visitor: Visitor) -> Iterator[str]:
    """The key of an approved mission of a real UAV."""
    page = visitor.signs_in("ada")
    towers = two_towers(page)
    uavs = simulated_uavs(page, NAME, at=towers[0]["geometry"]["coordinates"])
    key = stores_simulated_mission(page, "Over the belt", uavs, towers)
    writes(page, "PATCH", f"/uavs/{uavs[0]}", {"is_simulated": False})  # approved over flat ground, as this site has no terrain
    page.close()
    yield key
    page = visitor.signs_in("ada")
    for simulation in asks(page, "/simulations")["results"]:
        if simulation["mission"] and asks(page, f"/missions/{simulation['mission']}")["state"] in {"dispatched", "active"}:
            writes(page, "POST", f"/missions/{simulation['mission']}/abort", {"why": "The test is over."})
        writes(page, "DELETE", f"/simulations/{simulation['id']}")
    writes(page, "POST", f"/missions/{key}/revoke", {"reason": "The test is over."})
    for uav in uavs:
        writes(page, "PATCH", f"/uavs/{uav}", {"state": "retired", "name": f"Real {uav}"})
    for twin in asks(page, "/uavs?twins=true&state=all&limit=200")["features"]:
        if twin["properties"]["twin_of"] in uavs:
            writes(page, "PATCH", f"/uavs/{twin['id']}", {"name": f"Twin {twin['id']}"})


def flies_copy(page: Page, mission: str) -> str:
    """Returns the copy's key."""
    opened(page, f"/missions/{mission}/fly")
    page.get_by_role("region", name="Before start").get_by_role("button", name="Fly in simulation").click(timeout=SOON_MS)
    page.wait_for_url(lambda url: "/fly" in url and mission not in url, timeout=SOON_MS)
    expect(page.locator("html[data-loaded]")).to_be_attached(timeout=SOON_MS)
    return page.url.split("/missions/")[1].split("/")[0]


@pytest.mark.long
def test_one_click_leads_to_a_copy_that_simulated_twins_fly(visitor: Visitor, mission: str, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    before = asks(page, f"/missions/{mission}")
    copy = flies_copy(page, mission)
    notice = page.locator("#simulated-copy")
    expect(notice).to_contain_text("A copy of “Over the belt”, flown by simulated twins of its UAVs.")
    expect(panel_of(page).locator(".simulation-uavs")).to_contain_text(TWIN, timeout=SOON_MS)
    picture(page, "simulated-copy")
    assert faults(page) == []
    assert page.evaluate(TOO_WIDE) == []
    assert asks(page, f"/missions/{copy}")["simulates"] == mission
    notice.get_by_role("link", name="Back to the mission").click()
    expect(page.locator("#page-title")).to_have_text("Over the belt")
    expect(page.locator("#simulated-copy")).to_have_count(0)
    assert asks(page, f"/missions/{mission}") == before
    assert flies_copy(page, mission) == copy  # which flies already
    looks_only(visitor, mission)


def looks_only(visitor: Visitor, mission: str) -> None:
    page = opened(visitor.signs_in("vera"), f"/missions/{mission}/fly")
    expect(page.get_by_role("button", name="Fly in simulation")).to_have_count(0)
    page.close()


@pytest.mark.long
def test_a_copy_flies_to_its_end_and_its_log_says_so(visitor: Visitor, mission: str) -> None:
    page = visitor.signs_in("opal")
    flies_copy(page, mission)
    panel = page.get_by_role("region", name="Before start")
    panel.get_by_role("checkbox", name=re.compile("Looked at on site")).check(timeout=FLIGHT_MS)  # the upload comes by itself
    panel.get_by_role("button", name="Start 1 UAV").click(timeout=SOON_MS)
    answers(page, "Start in planned order")
    expect(page.locator("#mission-state")).to_have_text("In flight", timeout=SOON_MS)
    expect(card(page, re.escape(TWIN)).locator("[data-figure=height]")).to_contain_text(
        re.compile("(AGL|above take-off)[1-9]"), timeout=SOON_MS
    )
    panel_of(page).get_by_role("combobox", name="Speed").select_option(label="10× real time")
    expect(page.locator("#mission-state")).to_have_text("Completed", timeout=FLIGHT_MS)
    page.get_by_role("button", name="Event log").click()
    log = page.get_by_role("list", name="Event log")
    for words in (f"{TWIN} took off", f"{TWIN} landed", "Simulated UAVs started by opal"):
        expect(log.get_by_text(words)).to_be_visible(timeout=SOON_MS)
    assert asks(page, f"/missions/{mission}")["state"] == "approved"
