"""The panel of simulated UAVs on the page of a mission's flight: started, hurried, blown about, given faults, ended; and who only looks."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import TOO_WIDE, asks, wait_for_map
from tests.browser.pictures import Picture
from tests.browser.simulated_mission import (
    SOON_MS,
    answers,
    flies_in_simulation,
    opened,
    panel_of,
    retires,
    simulated_uavs,
    stores_simulated_mission,
    two_towers,
)  # fmt: skip
from tests.browser.test_accessibility import faults
from tests.browser.test_fleet import writes

pytestmark = pytest.mark.browser

NAMES = ("Avocet", "Ruff")


@pytest.fixture
def mission(visitor: Visitor) -> Iterator[str]:
    """The key of an approved mission of two simulated UAVs."""
    page = visitor.signs_in("ada")
    towers = two_towers(page)
    uavs = simulated_uavs(page, *NAMES, at=towers[0]["geometry"]["coordinates"])
    key = stores_simulated_mission(page, "Beside the belt", uavs, towers)
    page.close()
    yield key
    retires(visitor.signs_in("ada"), uavs)


def simulation_of(page: Page, mission: str) -> dict:
    return asks(page, f"/missions/{mission}/simulated-flights?state=all")["results"][0]


@pytest.mark.long
def test_simulated_uavs_are_started_changed_and_ended_one_by_one(visitor: Visitor, mission: str, picture: Picture) -> None:
    page = opened(visitor.signs_in("opal"), f"/missions/{mission}/fly")
    expect(page.get_by_role("region", name="Before start").get_by_role("button", name="Fly in simulation")).to_be_enabled()
    expect(page.locator("#simulation-state")).to_be_hidden()  # the drawer is folded
    panel = panel_of(page)
    expect(panel.locator("#simulation-state")).to_contain_text("start them here")
    picture(page, "simulation-before")
    flies_in_simulation(page, "5× real time")
    expect(panel.locator("#simulation-state")).to_have_text("2 simulated UAVs at 5× real time.")
    expect(panel.locator(".simulation-uavs li")).to_have_count(2)
    panel.get_by_role("combobox", name="Speed").select_option(label="2× real time")
    expect(panel.locator("#simulation-state")).to_contain_text("at 2× real time", timeout=SOON_MS)
    expect(panel.get_by_label("Wind and faults of")).to_have_value("")  # of nobody, until somebody is chosen
    expect(panel.get_by_role("button", name="Lose the link")).to_be_disabled()

    panel.get_by_label("Wind and faults of").select_option(label="Ruff")
    panel.get_by_role("spinbutton", name="Wind speed").fill("9")
    panel.get_by_role("spinbutton", name="From").fill("180")
    panel.get_by_role("spinbutton", name="Gusts").fill("2")
    panel.get_by_role("button", name="Set the wind").click()
    expect(page.locator("#spoken")).to_have_text("The wind has changed.")
    expect(panel.locator(".simulation-uavs li").filter(has_text="Ruff")).to_contain_text("wind 9 m/s from 180°, gusts 2 m/s")
    winds = {vehicle["name"]: vehicle["conditions"] for vehicle in simulation_of(page, mission)["vehicles"]}
    assert (winds["Ruff"]["wind"][0]["speed_mps"], winds["Ruff"]["gusts_mps"]) == (9.0, 2.0)
    assert winds["Avocet"]["wind"] == []

    panel.get_by_label("Link or GPS lost for").fill("300")
    expect(panel.locator("#simulation-lasts")).to_have_text("300 s real time = 600 s simulated")
    panel.get_by_role("button", name="Lose the link").click()
    ruff = panel.locator(".simulation-uavs li").filter(has_text="Ruff")
    expect(ruff).to_contain_text("link lost", timeout=SOON_MS)
    expect(panel.locator(".simulation-uavs li").filter(has_text="Avocet")).not_to_contain_text("link")
    picture(page, "simulation-panel-light")
    assert faults(page) == []
    panel.get_by_role("button", name="Clear faults").click()
    expect(ruff).not_to_contain_text("link", timeout=SOON_MS)

    panel.get_by_role("button", name="End Ruff").click()
    answers(page, "End Ruff")
    expect(ruff).to_contain_text("Ended", timeout=SOON_MS)
    expect(panel.locator("#simulation-state")).to_have_text("1 simulated UAV at 2× real time.", timeout=SOON_MS)
    expect(panel.get_by_role("button", name=re.compile("End Avocet"))).to_have_count(0)  # it is the simulation's end

    looks_only(visitor, mission, picture)
    panel.get_by_role("button", name="End the simulation").click()
    answers(page, "End the simulation")
    expect(panel.locator("#simulation-state")).to_contain_text("The simulation is over", timeout=SOON_MS)
    expect(panel.get_by_role("button", name="Fly in simulation")).to_be_visible()


def looks_only(visitor: Visitor, mission: str, picture: Picture) -> None:
    """A viewer sees how they do, on a phone and in the dark, and can do nothing."""
    page = opened(visitor.signs_in("vera", size=(390, 844), touch=True, theme="dark"), f"/missions/{mission}/fly")
    page.locator("#narrow-tabs label").filter(has_text="Alerts and targets").click()
    panel = panel_of(page)
    expect(panel.locator(".simulation-uavs")).to_contain_text("Avocet", timeout=SOON_MS)
    expect(panel.get_by_role("button")).to_have_count(0)
    expect(panel.get_by_role("combobox")).to_have_count(0)
    panel.scroll_into_view_if_needed()
    picture(page, "simulation-viewer-phone-dark")
    assert page.evaluate(TOO_WIDE) == []
    assert faults(page) == []
    page.close()


@pytest.mark.long
def test_the_panel_obeys_the_readers_units_and_language(visitor: Visitor, mission: str, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    before = {name: asks(page, "/account")[name] for name in ("language", "units")}
    try:
        writes(page, "PATCH", "/account", {"language": "de", "units": "imperial"})
        opened(page, f"/missions/{mission}/fly")
        panel = panel_of(page)
        panel.get_by_role("button", name="In der Simulation fliegen").click()
        expect(panel.locator(".simulation-uavs")).to_contain_text("am Boden", timeout=SOON_MS)
        expect(panel.locator(".simulation-three .unit")).to_have_text(["mph", "°", "mph"])
        panel.get_by_role("combobox", name="Gilt für").select_option(label="Alle UAVs dieser Mission")
        panel.get_by_role("spinbutton", name="Böen").fill("10")
        panel.get_by_role("button", name="Wind setzen").click()
        expect(page.locator("#spoken")).to_have_text("Der Wind hat sich geändert.")
        assert simulation_of(page, mission)["vehicles"][0]["conditions"]["gusts_mps"] == pytest.approx(4.4704)
        picture(page, "simulation-german-imperial")
        page.emulate_media(color_scheme="dark")
        picture(page, "simulation-german-imperial-dark")
        phone = visitor.opens(f"/missions/{mission}/fly", size=(390, 844), touch=True, cookies=page.context.cookies())
        wait_for_map(phone)
        phone.locator("#narrow-tabs label").last.click()
        panel_of(phone).scroll_into_view_if_needed()
        picture(phone, "simulation-phone-light")
        assert phone.evaluate(TOO_WIDE) == []
        assert faults(phone) == []
    finally:
        writes(page, "PATCH", "/account", before)
