"""Clicks that an operator needs on Fly, from approved to the follow-up, with two and with six UAVs. Seconds are printed alone."""

import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks
from tests.browser.regions import region
from tests.browser.simulated_mission import (
    away_m,
    card,
    has_nothing_open,
    opened,
    retires,
    simulated_uavs,
    stores_simulated_mission,
    until,
)
from tests.browser.test_fleet import writes

pytestmark = [pytest.mark.browser, pytest.mark.long]  # UAVs fly in real time

NAMES = ("Dunlin", "Knot", "Plover", "Curlew", "Whimbrel", "Turnstone")
TARGETS_EACH = 2
IN_THE_AIR = re.compile(r"(AGL|above take-off)\s*[1-9]")
SOON_MS, FLIGHT_MS = 90_000, 300_000
MAX_STARTS_S = 480.0
COUNTS_CLICKS = """() => {
    window.clicked = 0;
    addEventListener("click", (event) => { if (event.isTrusted && event.detail > 0) window.clicked += 1; }, true);
}"""


@dataclass
class Steps:
    """Clicks of each step as the page counts them, and seconds until its end."""

    page: Page
    clicks: dict[str, int] = field(default_factory=dict)

    def take(self, step: str, does: Callable[[], None], shown: Locator, words: str | re.Pattern[str]) -> None:
        began_s, before = time.monotonic(), self.page.evaluate("window.clicked")
        does()
        self.clicks[step] = self.page.evaluate("window.clicked") - before
        expect(shown).to_contain_text(words, timeout=FLIGHT_MS)
        print(f"{step}: {self.clicks[step]} clicks, {time.monotonic() - began_s:.0f} s")


@pytest.fixture(params=[2, 6])
def names(request: pytest.FixtureRequest) -> tuple[str, ...]:
    return NAMES[: request.param]


def nearest_m(tower: dict[str, Any], others: list[dict[str, Any]]) -> float:
    return min(away_m(tower["geometry"]["coordinates"], other["geometry"]["coordinates"]) for other in others)


@pytest.fixture
def mission(visitor: Visitor, names: tuple[str, ...]) -> Iterator[str]:
    """Approved; its simulated UAVs are not there yet."""
    page = visitor.signs_in("ada")
    towers = asks(page, f"/assets?kind=tower&bbox={region.spread_towers}&limit=200")["features"]
    uavs: list[int] = []
    targets: list[dict[str, Any]] = []
    for name in names:  # each beside towers of its own, so that no start waits for a route that crosses
        own = max(towers, key=lambda tower: nearest_m(tower, targets)) if targets else towers[0]
        towers.sort(key=lambda tower, own=own: away_m(tower["geometry"]["coordinates"], own["geometry"]["coordinates"]))
        uavs += simulated_uavs(page, name, at=own["geometry"]["coordinates"])
        targets += towers[:TARGETS_EACH]
    key = stores_simulated_mission(page, f"{len(names)} UAVs", uavs, targets)
    page.context.close()
    yield key
    page = visitor.signs_in("ada")
    if asks(page, f"/missions/{key}")["state"] == "active":
        writes(page, "POST", f"/missions/{key}/abort", {"why": "The test is over."})
    for uav in uavs:
        until(page, partial(has_nothing_open, page, uav), f"nothing waits for {uav}")
    retires(page, uavs)
    page.context.close()


def test_clicks_from_approved_to_the_follow_up(visitor: Visitor, mission: str, names: tuple[str, ...]) -> None:
    page = opened(visitor.signs_in("opal"), f"/missions/{mission}/fly")
    page.evaluate(COUNTS_CLICKS)
    steps = Steps(page)
    began_s = time.monotonic()
    start_all(page, len(names))
    steps.clicks["approved to airborne, all UAVs"] = page.evaluate("window.clicked")
    other, newest = take_offs(page, names)[-2:]
    print(f"approved to airborne, {len(names)} UAVs: {page.evaluate('window.clicked')} clicks, {time.monotonic() - began_s:.0f} s")
    steps.take("hold one", lambda: notify(page, newest, "Hold"), card(page, newest), "Holding")
    lose_gps(page, mission, other)
    steps.take("read the most urgent alert", lambda: None, page.locator("#alert-list .alert").first, other)
    steps.take("return one", lambda: notify(page, newest, "Return"), card(page, newest), re.compile("Return"))
    steps.take("return all", lambda: return_all(page), page.locator("#uav-cards"), re.compile("Return"))
    fly_fast(page)
    close = page.get_by_role("button", name="Close mission", exact=True)
    expect(close).to_be_enabled(timeout=FLIGHT_MS)
    before = page.evaluate("window.clicked")
    close.click()
    question = page.get_by_role("dialog")
    for reason in question.locator(".close-reasons input").all():
        reason.fill("Returned early")
    question.get_by_label("Plan a follow-up").check()
    steps.clicks["close the mission, with its follow-up"] = page.evaluate("window.clicked") - before + 1
    question.get_by_role("button", name="Close mission").click()
    expect(page).to_have_url(re.compile(r"/missions/[0-9a-f-]+$"), timeout=SOON_MS)
    print(steps.clicks)
    assert steps.clicks == {
        "approved to airborne, all UAVs": 4, "hold one": 3, "read the most urgent alert": 0, "return one": 2, "return all": 2,
        "close the mission, with its follow-up": 3,
    }  # fmt: skip


def start_all(page: Page, uavs: int) -> None:
    panel = page.get_by_role("region", name="Before start")
    panel.get_by_role("button", name="Fly in simulation").click(timeout=SOON_MS)  # they connect, and the mission is uploaded to them
    panel.get_by_role("checkbox", name=re.compile("Looked at on site")).check(timeout=FLIGHT_MS)
    panel.get_by_role("button", name=f"Start {uavs} UAVs").click(timeout=FLIGHT_MS)
    page.get_by_role("dialog").get_by_role("button", name="Start in planned order").click()


def take_offs(page: Page, names: tuple[str, ...]) -> list[str]:
    """In the order in which they were seen in the air; the first may be down again when the last takes off."""
    seen: list[str] = []
    until_s = time.monotonic() + MAX_STARTS_S
    while len(seen) < len(names):
        assert time.monotonic() < until_s, f"only {seen} have taken off"
        heights = {name: card(page, name).locator("[data-figure=height]").inner_text() for name in names if name not in seen}
        seen += [name for name, text in heights.items() if IN_THE_AIR.search(text.replace("\n", " "))]
        page.wait_for_timeout(500)
    return seen


def notify(page: Page, name: str, act: str) -> None:
    """By its card, the button over the map and the question; a UAV that is selected already keeps its card."""
    bar = page.get_by_role("group", name=f"Commands to {name}")
    if not bar.is_visible():
        card(page, name).get_by_role("button", name=re.compile(name)).first.click()
    bar.get_by_role("button", name=act, exact=True).click()
    page.get_by_role("dialog").locator(".acts button").last.click()
    expect(page.get_by_role("dialog")).to_have_count(0)


def return_all(page: Page) -> None:
    page.get_by_role("button", name="Return all").click()
    page.get_by_role("dialog").locator(".acts button").last.click()
    expect(page.get_by_role("dialog")).to_have_count(0)


def _vehicles(page: Page, mission: str) -> dict[str, str]:
    found = next(one for one in asks(page, "/simulations")["results"] if one["mission"] == mission)
    return {vehicle["uav"]["name"]: vehicle["id"] for vehicle in found["vehicles"]}


def lose_gps(page: Page, mission: str, name: str) -> None:
    """For long enough that an alert stands, which stays until it is acknowledged."""
    writes(page, "PATCH", f"/simulated-vehicles/{_vehicles(page, mission)[name]}", {"faults": {"gps_lost_for_s": 8}})


def fly_fast(page: Page) -> None:
    panel = page.get_by_role("region", name="Simulation")
    panel.locator("summary").click()
    panel.get_by_role("combobox").first.select_option(label="10× real time")
