"""The live page: one operator starts a flight, another sees it move, an alert, an acknowledgement; and a page that is cut off says so."""

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
from tests.browser.simulated_mission import card, opened, starts
from tests.browser.test_accessibility import faults
from tests.browser.test_fleet import writes

pytestmark = [pytest.mark.browser, pytest.mark.long]  # UAVs fly in real time

STARTS = {"Kite": region.east, "Tern": [region.east[0] + 0.015, region.east[1] - 0.005]}
STEP_M = 9.0
MAX_STEPS = 30


@pytest.fixture
def flight(visitor: Visitor, site: Site) -> Iterator[tuple[str, list[Flyer]]]:
    """The address of a mission that is approved and sent to two UAVs, and the UAVs, which have taken it."""
    page = visitor.signs_in("ada")
    uavs = [
        writes(page, "POST", "/uavs", {"name": name, "position": at, "is_simulated": True, "type": unlimited_type(page), "link": "http"})[
            "id"
        ]
        for name, at in STARTS.items()
    ]
    tokens = [writes(page, "POST", f"/uavs/{uav}/credentials", {"kind": "link-token"})["secret"] for uav in uavs]
    towers = asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=5")["features"]
    made = writes(
        page,
        "POST",
        "/missions",
        {
            "name": "South belt, live", "uavs": [{"id": uav, "most_targets": 3} for uav in uavs],
            "targets": [{"asset": tower["id"]} for tower in towers], "objective": "makespan", "return_to_start": True, "plan": True,
        },
    )  # fmt: skip
    mission = made["id"]
    writes(page, "POST", f"/missions/{mission}/approve")
    writes(page, "POST", f"/missions/{mission}/dispatch")
    flyers = [Flyer(HttpLink(site.address, token)) for token in tokens]
    for flyer in flyers:
        flyer.obeys()
        assert flyer.content is not None
    page.close()
    yield mission, flyers
    page = visitor.signs_in("ada")
    if asks(page, f"/missions/{mission}")["state"] in {"dispatched", "active"}:
        writes(page, "POST", f"/missions/{mission}/abort")
        for flyer in flyers:
            flyer.obeys()
    for uav in uavs:
        writes(page, "PATCH", f"/uavs/{uav}", {"state": "retired", "name": f"Flown {uav}"})


def flies_until(
    page: Page, fact: Any, flyers: list[Flyer], along_m: float, *, drifts_m: float = 0.0, most: int = MAX_STEPS, **reported: Any
) -> float:
    """A report a second of each until the page shows what is waited for; the first drifts aside. Returns how far they have come."""
    for step in range(most):
        if fact():
            return along_m
        along_m += STEP_M
        for number, flyer in enumerate(flyers):
            flyer.obeys()
            flyer.reports(along_m, aside_m=0.0 if number else drifts_m * step, **reported)
        page.wait_for_timeout(1000)  # a UAV reports once a second
    raise AssertionError("the page does not show it")


def test_one_operator_starts_a_flight_and_another_sees_it_move_an_alert_and_an_acknowledgement(
    visitor: Visitor, flight: tuple[str, list[Flyer]], picture: Picture
) -> None:
    mission, flyers = flight
    pilot = opened(visitor.signs_in("opal"), f"/missions/{mission}/fly")
    watcher = opened(visitor.signs_in("rory"), f"/missions/{mission}/fly")
    expect(watcher.locator("#mission-state")).to_have_text("Uploaded")
    first, second = (uav["name"] for uav in asks(pilot, f"/missions/{mission}")["uavs"])
    for name in (first, second):
        starts(visitor, pilot, name)  # the second one's slot is later

    kite = card(watcher, "Kite")
    along_m = flies_until(watcher, lambda: watcher.locator("#mission-state").inner_text() == "In flight", flyers, 0.0)
    expect(watcher.locator(".map-flyer.measured")).to_have_count(2)
    first = watcher.locator(".map-flyer").first.get_attribute("style")
    along_m = flies_until(watcher, lambda: watcher.locator(".map-flyer").first.get_attribute("style") != first, flyers, along_m)
    expect(kite.locator("[data-figure=age] dd")).to_have_text(re.compile(r"^\d(\.\d)?\ss$"))
    expect(kite.locator("[data-figure=height]")).to_contain_text(re.compile("AGL|above take-off"))
    expect(kite.locator(".live-strip")).to_be_visible()

    off_route = watcher.locator(".alert").filter(has_text="beside its route")
    flies_until(watcher, lambda: off_route.count() > 0, flyers, along_m, drifts_m=6.0)
    expect(watcher.locator("#alert-badge")).not_to_have_text("")
    kite.get_by_role("button", name=re.compile("Kite")).click()
    expect(watcher.get_by_role("group", name="Commands to Kite")).to_be_visible()
    watcher.keyboard.press("Shift+R")
    question = watcher.get_by_role("dialog", name="Return Kite?")
    expect(question).to_contain_text("battery 71", ignore_case=True)
    in_both_themes(watcher, picture, "live-question")
    question.get_by_role("button", name="Keep flying").click()
    assert [kind for flyer in flyers for kind in flyer.reported if kind == "return"] == []
    in_both_themes(watcher, picture, "live")
    assert faults(watcher) == []
    assert watcher.evaluate(TOO_WIDE) == []

    third = opened(visitor.signs_in("vera"), "/live")
    expect(third.locator(".alert").first).to_be_visible()
    expect(third.get_by_role("button", name="Acknowledge")).to_have_count(0)
    expect(third.locator(".command-bar")).to_have_count(0)
    off_route.get_by_role("button", name="Acknowledge").first.click()
    expect(third.locator(".alert.known").filter(has_text="Acknowledged by rory")).to_be_visible()

    watcher.keyboard.press("Shift+R")
    expect(question).to_contain_text("It returns to its take-off place and lands.")
    flyers[0].reports(along_m, mode="RTL")  # its failsafe, while the question stands
    expect(question).to_contain_text("Kite is already returning. This command was not sent.")
    question.get_by_role("button", name="Close").click()
    expect(question).to_have_count(0)

    changed = watcher.locator("#alert-list .alert.critical").filter(has_text="not commanded from here")
    along_m = flies_until(watcher, lambda: changed.count() == 2, flyers, along_m, mode="RTL")
    together = watcher.get_by_role("button", name=re.compile(r"^Acknowledge all ended \(\d+\)$"))
    flies_until(watcher, lambda: changed.count() == 0 and together.is_visible(), flyers, along_m)
    together.click()
    expect(watcher.locator("#toasts")).to_have_text(re.compile(r"^\d+ ended alerts acknowledged\.$"))
    expect(together).to_be_hidden()
    expect(watcher.locator("#alert-list .alert").filter(has_text="not commanded from here")).to_have_count(0)


def test_a_uav_that_is_silent_is_estimated_and_a_page_that_is_cut_off_says_so(
    visitor: Visitor, flight: tuple[str, list[Flyer]], picture: Picture
) -> None:
    mission, flyers = flight
    page = visitor.signs_in("opal")
    for uav in {command["uav"]["id"] for command in asks(page, f"/missions/{mission}/commands")["results"]}:
        writes(page, "POST", f"/uavs/{uav}/commands", {"kind": "start", "parameters": {"out_of_slot": True}})
    opened(page, f"/missions/{mission}/fly")
    along_m = flies_until(page, lambda: page.locator(".map-flyer.measured").count() == 2, flyers, 300.0)
    kite = card(page, "Kite")
    flies_until(page, lambda: kite.locator(".estimate").is_visible(), flyers[1:], along_m)
    expect(kite.locator(".estimate")).to_contain_text("(95 %)")
    expect(kite.locator(".figures")).to_contain_text("~")
    expect(page.locator(".map-flyer.estimated")).to_have_count(1)
    silent = page.locator("#alert-list .alert").filter(has_text="no telemetry for")
    expect(silent).to_contain_text("(last message ")
    expect(silent).to_contain_text("Planned for link loss: it continues its mission by itself.")
    stated = silent.locator(".alert-title").inner_text()
    expect(silent.locator(".alert-title")).not_to_have_text(stated)
    kite.get_by_role("button", name=re.compile("Kite")).click()
    in_both_themes(page, picture, "live-estimated")

    phone = visitor.signs_in("rory", size=(390, 844), touch=True)
    opened(phone, f"/missions/{mission}/fly")
    card(phone, "Kite").get_by_role("button", name=re.compile("Kite")).click()
    expect(phone.locator(".command-bar")).to_be_visible()
    assert phone.evaluate(TOO_WIDE) == []
    assert faults(phone) == []
    in_both_themes(phone, picture, "live-phone")

    page.context.set_offline(True)
    page.evaluate("dispatchEvent(new Event('offline'))")
    expect(page.locator("#stale")).to_contain_text("everything here is as of then. Connecting again.", timeout=60_000)
    in_both_themes(page, picture, "live-stale")
    page.context.set_offline(False)
    expect(page.locator("#stale")).to_be_hidden()
    visitor.complaints[:] = [words for words in visitor.complaints if "ERR_INTERNET_DISCONNECTED" not in words]
