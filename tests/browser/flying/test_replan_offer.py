"""A UAV drops out of a flight: another plan is offered on every page, taken on one, flown, and told by the record."""

import math
import re
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from itertools import count
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Site, Visitor
from tests.browser.flying.uav_by_mavlink import Autopilot
from tests.browser.operator_map import asks, unlimited_type, wait_for_map
from tests.browser.pictures import Picture, in_both_themes
from tests.browser.regions import region
from tests.browser.simulated_mission import card, has_nothing_open, opened, starts, until
from tests.browser.test_accessibility import faults
from tests.browser.test_fleet import writes
from tests.telemetry.vehicles.px4 import Px4

pytestmark = pytest.mark.browser

NAMES = ("Dunlin", "Ruff")
NAME = "South belt, two by two"
TOWERS, BESIDE_DEG = 10, 0.002
_systems = count(201)  # of no other test, and of each run its own
LANDS_WITHIN_MS, WORKED_OUT_WITHIN_MS, UPLOADED_WITHIN_MS = 700_000, 40_000, 60_000


@dataclass
class Flight:
    mission: str
    vehicles: dict[str, Autopilot]


@pytest.fixture
def flight(visitor: Visitor, site: Site) -> Iterator[Flight]:
    """A mission whose two UAVs have it on board and stand ready; both speak MAVLink to the installation's own gateway."""
    page = visitor.signs_in("ada")
    towers = _in_a_row(asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=200")["features"])
    uavs, vehicles = [], {}
    for name, tower in zip(NAMES, (towers[0], towers[-1]), strict=True):
        at = (tower["geometry"]["coordinates"][0], tower["geometry"]["coordinates"][1] + BESIDE_DEG)
        system = next(_systems)
        stated = {
            "name": name,
            "position": at,
            "is_simulated": True,
            "type": unlimited_type(page),
            "link": "mavlink",
            "mavlink_system_id": system,
            "allows_unsigned": True,
        }
        uavs.append(writes(page, "POST", "/uavs", stated)["id"])
        vehicles[name] = Autopilot(Px4(system=system), site.gateway_port, at=at)
    made = writes(
        page,
        "POST",
        "/missions",
        {
            "name": NAME, "uavs": [{"id": uav} for uav in uavs], "targets": [{"asset": tower["id"]} for tower in towers],
            "objective": "makespan", "return_to_start": True, "plan": True,
        },
    )  # fmt: skip
    mission = made["id"]
    with ExitStack() as flying:
        for vehicle in vehicles.values():
            flying.enter_context(vehicle)
        writes(page, "POST", f"/missions/{mission}/approve")
        writes(page, "POST", f"/missions/{mission}/dispatch")
        page.close()
        yield Flight(mission, vehicles)
        page = visitor.signs_in("ada")
        for entry in asks(page, "/missions?limit=50")["results"]:
            if entry["name"].startswith(NAME) and entry["state"] in {"dispatched", "active"}:
                writes(page, "POST", f"/missions/{entry['id']}/abort")
        for uav in uavs:
            until(page, partial(has_nothing_open, page, uav), "the UAV has done what it was commanded")
            writes(page, "PATCH", f"/uavs/{uav}", {"state": "retired", "name": f"Flown {uav}"})


def _in_a_row(supports: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Every second of the towers nearest to the first, from west to east; poles stand too close for a flight that lasts."""
    towers = [support for support in supports if support["properties"]["subtype"] == "tower"]
    (lon, lat) = towers[0]["geometry"]["coordinates"][:2]

    def far_deg(tower: dict[str, Any]) -> float:
        other = tower["geometry"]["coordinates"]
        return math.hypot((other[0] - lon) * math.cos(math.radians(lat)), other[1] - lat)

    return sorted(sorted(towers, key=far_deg)[: 2 * TOWERS : 2], key=lambda tower: tower["geometry"]["coordinates"][0])


def drops_out(visitor: Visitor, flight: Flight) -> tuple[Page, Page]:
    """The pages of who started the flight and of who watches it, once another plan is offered on both."""
    pilot = opened(visitor.signs_in("opal"), f"/missions/{flight.mission}/fly")
    watcher = opened(visitor.signs_in("rory"), f"/missions/{flight.mission}/fly")
    expect(pilot.get_by_role("button", name="Start 2 UAVs")).to_be_visible(timeout=UPLOADED_WITHIN_MS)  # menus stay
    for name in NAMES:
        starts(visitor, pilot, name)
    expect(watcher.locator("#mission-state")).to_have_text("In flight")
    expect(watcher.locator(".map-flyer.measured")).to_have_count(2)
    for name, height in (("Ruff", r"[1-9]\d"), ("Dunlin", r"[4-9]\d")):  # they have climbed
        expect(card(watcher, name).locator("[data-figure=height]")).to_contain_text(re.compile(rf"(AGL|above take-off)\s*{height}"))
    flight.vehicles["Dunlin"].comes_home()
    lost = watcher.locator(".alert.critical").filter(has_text="not commanded from here")
    lost.get_by_role("button", name="Acknowledge").click()
    pilot.goto("/live")
    expect(pilot.locator(".alert.known").filter(has_text=re.compile("^Critical: Dunlin.*Acknowledged by rory", re.DOTALL))).to_be_visible()
    for page in (pilot, watcher):
        expect(page.locator("#offers")).to_contain_text("A UAV has dropped out. 1 UAV gets another route", timeout=WORKED_OUT_WITHIN_MS)
        expect(page.locator("#offers")).to_contain_text(re.compile(r"Ruff gets another route \+\d"))
    return pilot, watcher


def accepts(page: Page) -> None:
    """One that expires before it is taken is followed by another."""
    expired = page.get_by_text("Nothing was sent. Check the re-plan offered now.")
    for _offer in range(3):
        expect(page.locator("#offers .countdown")).to_have_text(re.compile(r"^Valid for [0-2]:\d\d"))
        page.locator("#offers").get_by_role("button", name="Accept").click()
        question = page.get_by_role("dialog", name="Accept the re-plan?")
        expect(question).to_contain_text("Ruff: held, given the new route while they hover, and started again.")
        question.get_by_role("button", name="Accept re-plan").click()
        taken = page.locator("#offers").get_by_text("Re-plan accepted.")
        taken.or_(expired).first.wait_for()
        if taken.count():
            return
    raise AssertionError("no offer could be taken")


@pytest.mark.long
def test_what_one_uav_leaves_is_offered_taken_by_one_operator_and_seen_by_the_other(
    visitor: Visitor, flight: Flight, picture: Picture
) -> None:
    pilot, watcher = drops_out(visitor, flight)
    in_both_themes(watcher, picture, "live-offer")
    assert faults(watcher) == []
    accepts(watcher)
    expect(pilot.locator("#offers")).to_contain_text("Re-plan accepted. Decided by rory")
    pilot.close()
    expect(watcher.locator("#mission-state")).to_have_text("Aborted")
    watcher.get_by_role("link", name="Follow the new mission").click()
    wait_for_map(watcher)
    expect(watcher.get_by_role("heading", name=f"{NAME}, continued")).to_be_visible()
    expect(watcher.locator("#mission-state")).to_have_text("In flight", timeout=40_000)
    ruff = card(watcher, "Ruff")
    expect(ruff.locator(".card-command")).to_contain_text("Start: done")
    expect(ruff.locator(".live-strip")).to_have_accessible_name(re.compile(r"Ruff: \d of \d+ targets"))

    watcher.goto(f"/missions/{flight.mission}/report")
    wait_for_map(watcher)
    expect(watcher.get_by_role("region", name=re.compile("^Not inspected"))).to_contain_text(f"Taken over by {NAME}, continued")


@pytest.mark.long
def test_the_other_plan_is_flown_to_its_end_and_told_by_its_record(visitor: Visitor, flight: Flight, picture: Picture) -> None:
    pilot, watcher = drops_out(visitor, flight)
    pilot.set_viewport_size({"width": 390, "height": 844})
    in_both_themes(pilot, picture, "live-offer-phone")
    accepts(watcher)
    watcher.get_by_role("link", name="Follow the new mission").click()
    pilot.close()
    wait_for_map(watcher)
    expect(watcher.locator("#mission-state")).to_have_text("Completed", timeout=LANDS_WITHIN_MS)
    expect(card(watcher, "Ruff").locator(".card-head .letter")).to_have_text("A")
    expect(watcher.locator(".alert")).to_have_count(0)
    in_both_themes(watcher, picture, "live-over")
    watcher.goto(watcher.url.replace("/fly", "/report"))
    wait_for_map(watcher)
    expect(watcher.get_by_role("heading", name=re.compile(r"^(\d+) of \1 targets inspected$"))).to_be_visible()
    in_both_themes(watcher, picture, "record-continued")


@pytest.mark.long
def test_an_offer_that_is_declined_changes_nothing_and_the_other_page_says_who_did(visitor: Visitor, flight: Flight) -> None:
    pilot, watcher = drops_out(visitor, flight)
    pilot.locator("#offers").get_by_role("button", name="Decline").click()
    expect(watcher.locator("#offers")).to_contain_text("the approved plan continues. Decided by opal")
    expect(watcher.locator("#mission-state")).to_have_text("In flight")
