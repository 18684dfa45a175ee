"""Live over six missions of ten UAVs: call signs that tell them apart, rows under missions, a filter, labels clear of each other."""

import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from examples.companion.link import HttpLink
from tests.browser.conftest import Site, Visitor
from tests.browser.flying.uav_over_http import Flyer
from tests.browser.operator_map import TOO_WIDE, asks, unlimited_type
from tests.browser.pictures import Picture, in_both_themes
from tests.browser.regions import region
from tests.browser.test_accessibility import faults
from tests.browser.test_fleet import writes

pytestmark = [pytest.mark.browser, pytest.mark.long]

MISSIONS, UAVS_EACH = 6, 10
BESIDE_DEG = 0.0006  # some 50 m from its tower, so that routes keep clear of each other
COVERED = """() => {
    const shown = [...document.querySelectorAll(".flyer-label, .map-cluster")]
        .filter((element) => element.checkVisibility({ visibilityProperty: true, opacityProperty: true }));
    const boxes = shown.map((element) => [element.textContent, element.getBoundingClientRect()]);
    return boxes.flatMap(([words, a], index) => boxes.slice(index + 1)
        .filter(([, b]) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1)
        .map(([other]) => `${words} on ${other}`));
}"""
COUNTED = """() => [...document.querySelectorAll(".map-cluster")].reduce((sum, one) => sum + Number(one.textContent), 0)
    + [...document.querySelectorAll(".map-flyer")].filter((one) => !one.hidden).length"""


def sent(page: Page, site: Site, number: int, towers: list[dict[str, Any]]) -> list[Flyer]:
    """A mission that is on board of its ten UAVs."""
    at = [[tower["geometry"]["coordinates"][0] + BESIDE_DEG, tower["geometry"]["coordinates"][1]] for tower in towers]  # one at each
    made = [
        writes(
            page,
            "POST",
            "/uavs",
            {"name": f"Falcon {number}{column}", "position": place, "is_simulated": True, "type": unlimited_type(page), "link": "http"},
        )["id"]
        for column, place in enumerate(at)
    ]
    body = {
        "name": f"Section {number}", "uavs": [{"id": uav, "most_targets": 1} for uav in made],
        "targets": [{"asset": tower["id"]} for tower in towers], "objective": "makespan", "return_to_start": True, "plan": True,
    }  # fmt: skip
    mission = writes(page, "POST", "/missions", body)["id"]
    writes(page, "POST", f"/missions/{mission}/approve")
    writes(page, "POST", f"/missions/{mission}/dispatch")
    tokens = [writes(page, "POST", f"/uavs/{uav}/credentials", {"kind": "link-token"})["secret"] for uav in made]
    flyers = [Flyer(HttpLink(site.address, token)) for token in tokens]
    for flyer in flyers:
        flyer.obeys()
    return [flyer for flyer in flyers if flyer.content]


@pytest.fixture(scope="module")
def sixty(site: Site, contexts: Any, without_leftovers: None) -> Iterator[list[Flyer]]:
    visitor = Visitor(site, contexts)
    page = visitor.signs_in("ada")
    towers = asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=200")["features"][: MISSIONS * UAVS_EACH]
    flyers = [flyer for number in range(MISSIONS) for flyer in sent(page, site, number, towers[number::MISSIONS][:UAVS_EACH])]
    visitor.leaves()
    yield flyers


def all_report(flyers: list[Flyer], along_m: float) -> None:
    for flyer in flyers:
        flyer.reports(along_m, wind_north_mps=-3.0, wind_east_mps=0.0)


def opened(visitor: Visitor, **how: Any) -> Page:
    page = visitor.signs_in("opal", **how)
    page.goto("/live")
    page.locator("html[data-loaded]").wait_for(state="attached")  # its map is never idle: UAVs move
    return page


def test_sixty_uavs_of_six_missions_are_told_apart_found_and_never_cover_each_other(
    visitor: Visitor, sixty: list[Flyer], picture: Picture
) -> None:
    all_report(sixty, 300.0)
    page = opened(visitor)
    cards = page.locator("#uav-cards .card")
    expect(cards).to_have_count(len(sixty))
    assert len(sixty) >= 50  # a plan may leave a UAV without a target
    expect(page.locator("#uav-cards .group-head")).to_have_count(MISSIONS)
    signs = cards.locator(".card-row .letter").all_inner_texts()
    assert len(set(signs)) == len(signs)
    assert all(re.fullmatch(r"[1-6][A-J]", sign) for sign in signs)
    heights = page.evaluate("() => [...document.querySelectorAll('.card-row')].map((row) => row.offsetHeight)")
    assert set(heights) == {56}
    assert page.evaluate(COVERED) == []
    assert page.evaluate(COUNTED) == len(sixty)
    assert faults(page) == []
    in_both_themes(page, picture, "live-fleet")

    page.get_by_role("searchbox", name="Find a UAV or a mission").fill("Section 3")
    expect(page.locator("#uav-cards .group-head")).to_have_count(1)
    expect(page.get_by_text(re.compile(r"^\d+ of \d+ UAVs shown\."))).to_be_visible()
    assert page.evaluate(COUNTED) == len(sixty)  # the list is shorter, the map is not
    first = cards.first
    first.get_by_role("button").first.click()
    expect(first).to_contain_text("Wind 3 m/s from 0°, reported by its companion computer")
    expect(first.locator(".figures")).to_be_visible()
    page.get_by_role("button", name="Clear the filter").click()
    expect(cards).to_have_count(len(sixty))
    expect(page.locator(".board-group")).to_have_count(MISSIONS)
    assert page.evaluate(COVERED) == []


def test_on_a_phone_each_uav_is_a_row_of_56_px_and_a_tap_opens_its_card(visitor: Visitor, sixty: list[Flyer], picture: Picture) -> None:
    all_report(sixty, 330.0)
    page = opened(visitor, size=(360, 780), touch=True)
    rows = page.locator(".card-row")
    expect(rows).to_have_count(len(sixty))
    assert set(page.evaluate("() => [...document.querySelectorAll('.card-row')].map((row) => row.offsetHeight)")) == {56}
    assert page.evaluate(TOO_WIDE) == []
    in_both_themes(page, picture, "live-fleet-phone")
    rows.first.click()
    expect(page.locator(".card.chosen .figures")).to_be_visible()
    expect(rows.first).to_have_attribute("aria-pressed", "true")
    assert faults(page) == []
    in_both_themes(page, picture, "live-fleet-phone-card")
    rows.first.click()
    expect(page.locator(".card.chosen")).to_have_count(0)
