"""A flight day: two missions of three simulated UAVs each, commands that reach one mission alone, faults and what is said of them."""

import re
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Site, Visitor
from tests.browser.flying.frozen_line import line_to
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

FLEETS = {"South": ("Tern", "Kite", "Gull"), "North": ("Crow", "Rook", "Swift")}
FLIES_MS = 180_000
STALE_S = 6.0

# By the page's own clock, which is this machine's: asking the page takes time of its own.
NOTES_WHEN_IT_IS_SHOWN = """() => {
    const stale = document.getElementById("stale");
    new MutationObserver(() => { if (!stale.hidden) window.shownAt ??= Date.now(); }).observe(stale, { attributes: true });
}"""


@dataclass(frozen=True)
class Flown:
    """A mission with its simulated UAVs by name: keys of the fleet, and of the simulation."""

    mission: str
    uavs: dict[str, int]
    vehicles: dict[str, str]


def commands_of(page: Page, uav: int) -> list[str]:
    """Kinds, the newest last."""
    return [one["kind"] for one in reversed(asks(page, f"/uavs/{uav}/commands?limit=100")["results"])]


def is_started(page: Page, uav: int) -> bool:
    """One that expired before it was delivered is given again, as somebody at the page would."""
    newest = asks(page, f"/uavs/{uav}/commands?limit=1")["results"][0]
    if newest["kind"] != "start" or newest["state"] in {"expired", "failed"}:
        writes(page, "POST", f"/uavs/{uav}/commands", {"kind": "start", "parameters": {"out_of_slot": True}})
    return bool(newest["kind"] == "start" and newest["state"] == "applied")


def is_flown(page: Page, name: str, towers: list[dict[str, Any]]) -> Flown:
    """Planned, approved, on its simulated UAVs, and started in planned order or out of it."""
    uavs = dict(zip(FLEETS[name], simulated_uavs(page, *FLEETS[name], at=towers[0]["geometry"]["coordinates"]), strict=True))
    mission = stores_simulated_mission(page, name, list(uavs.values()), towers)
    simulation = writes(page, "POST", f"/missions/{mission}/simulated-flights", {"speed": 1, "conditions": "calm"})
    vehicles = {one["uav"]["name"]: one["id"] for one in simulation["vehicles"]}
    writes(page, "POST", f"/missions/{mission}/dispatch")

    def loaded() -> bool:
        given = asks(page, f"/missions/{mission}/commands?limit=100")["results"]
        return {one["uav"]["name"] for one in given if one["kind"] == "upload-mission" and one["state"] == "applied"} == set(uavs)

    until(page, loaded, "each has its route")
    for uav in uavs.values():
        until(page, lambda uav=uav: is_started(page, uav), f"{uav} is started", within_s=240.0)
    return Flown(mission, uavs, vehicles)


@pytest.fixture
def day(visitor: Visitor) -> Iterator[dict[str, Flown]]:
    page = visitor.signs_in("ada")
    found = asks(page, f"/assets?kind=tower&bbox={region.spread_towers}&limit=200")["features"]
    origin = found[0]["geometry"]["coordinates"]
    found.sort(key=lambda tower: away_m(tower["geometry"]["coordinates"], origin))
    groups = {"South": found[:6], "North": found[-6:]}
    flown = {name: is_flown(page, name, towers) for name, towers in groups.items()}
    page.context.close()
    yield flown
    page = visitor.signs_in("ada")
    for one in flown.values():
        for name in one.vehicles:
            breaks(page, one, name, link_lost_for_s=0, gps_lost_for_s=0)
        writes(page, "POST", f"/missions/{one.mission}/abort", {"why": "The day is over."})
        for uav in one.uavs.values():
            until(page, lambda uav=uav: has_nothing_open(page, uav), f"nothing waits for {uav}")
        retires(page, list(one.uavs.values()))
    page.context.close()


def in_flight(page: Page, flown: Flown) -> None:
    for name in flown.uavs:
        height = card(page, name).locator("[data-figure=height]")
        expect(height).to_contain_text(re.compile(r"(AGL|above take-off)\s*[1-9]\d"), timeout=FLIES_MS)


def flies_away(page: Page, flown: Flown, name: str) -> bool:
    """Farther from where it took off than a UAV that is down at home may be."""
    routes = asks(page, f"/missions/{flown.mission}")["plan"]["routes"]
    home = routes[list(flown.uavs).index(name)]["waypoints"][0]["position"]
    latest = asks(page, f"/uavs/{flown.uavs[name]}/telemetry/latest")
    return bool(latest["geometry"]) and away_m(latest["geometry"]["coordinates"], home) > 60.0


def breaks(page: Page, flown: Flown, name: str, **faults: Any) -> None:
    body = {"conditions": faults.pop("conditions")} if "conditions" in faults else {}
    writes(page, "PATCH", f"/simulated-vehicles/{flown.vehicles[name]}", body | ({"faults": faults} if faults else {}))


def open_alert(page: Page, uav: int, *codes: str, level: str | None = None) -> dict[str, Any]:
    def found() -> dict[str, Any] | None:
        alerts = asks(page, f"/alerts?uav={uav}&limit=100")["results"]
        return next((one for one in alerts if one["code"] in codes and (level is None or one["level"] == level)), None)

    return dict(until(page, found, f"{codes} of {uav}"))


def test_a_flight_day_of_two_missions(visitor: Visitor, site: Site, day: dict[str, Flown]) -> None:
    page = visitor.signs_in("ada")
    south, north = day["South"], day["North"]
    opened(page, f"/missions/{south.mission}/fly")
    in_flight(page, south)
    batch_reaches_one_mission(page, south, north)
    faults_are_reported(page, south, north)
    blind_pages_blame_no_uav(visitor, site, north)
    returning_and_abort_reach_one_mission(page, south, north)
    page.context.close()


def batch_reaches_one_mission(page: Page, south: Flown, north: Flown) -> None:
    before = {name: commands_of(page, uav) for name, uav in north.uavs.items()}
    for kind in ("pause", "resume", "hold"):  # by the API
        answer = writes(page, "POST", f"/missions/{south.mission}/commands", {"kind": kind})
        assert {one["name"] for one in answer["results"] if one["is_accepted"]} == set(south.uavs), answer
        applied = lambda kind=kind: all(  # noqa: E731
            any(one["kind"] == kind and one["state"] == "applied" for one in asks(page, f"/uavs/{uav}/commands?limit=5")["results"])
            for uav in south.uavs.values()
        )
        until(page, applied, f"{kind} of all")
    refused = writes(page, "POST", f"/missions/{south.mission}/commands", {"kind": "land", "uavs": list(north.uavs.values())})
    assert not any(one["is_accepted"] for one in refused["results"])
    page.get_by_role("button", name="Return all").click()  # and on the page
    question = page.get_by_role("dialog", name="Return all 3 UAVs?")
    for name in south.uavs:
        expect(question).to_contain_text(name)
    for name in north.uavs:
        expect(question).not_to_contain_text(name)
    question.get_by_role("button", name="Keep flying").click()
    assert {name: commands_of(page, uav) for name, uav in north.uavs.items()} == before


def faults_are_reported(page: Page, south: Flown, north: Flown) -> None:
    tern, kite, gull = south.uavs.values()
    breaks(page, south, "Tern", gps_lost_for_s=3_600)
    breaks(page, south, "Kite", link_lost_for_s=3_600)
    breaks(page, south, "Gull", battery_wh_left=6)
    until(page, lambda: flies_away(page, north, "Crow"), "Crow is on its way", within_s=180.0)
    breaks(page, north, "Crow", motor_failed=1)
    gps = open_alert(page, tern, "gps")
    assert "GPS" in gps["message"] or "where it is" in gps["message"]
    assert [act["kind"] for act in gps["acts"]][:1] in (["land"], ["take-over"]), gps
    link = open_alert(page, kite, "link-lost", level="critical")
    assert re.search("lost|no message", link["message"], re.IGNORECASE), link
    battery = open_alert(page, gull, "battery-short", level="critical")
    if battery["own_act"] is None:  # else its failsafe brings it down already, and nothing is to be done
        assert battery["acts"][0]["kind"] in {"return", "land"}, battery
    down = open_alert(page, north.uavs["Crow"], "down-off-plan", level="critical")
    assert "crashed" in down["message"]
    writes(page, "PATCH", f"/simulated-vehicles/{south.vehicles['Gull']}", {"conditions": "strong-wind"})
    expect(page.locator(".alert").filter(has_text="battery").first).to_be_visible(timeout=60_000)
    breaks(page, south, "Tern", gps_lost_for_s=0)
    critical_stays_until_acknowledged(page, gps)


def critical_stays_until_acknowledged(page: Page, alert: dict[str, Any]) -> None:
    """Also once its cause has gone."""
    key = f"/alerts/{alert['id']}"
    until(page, lambda: asks(page, key)["closed_at"], f"the cause of {alert['message']} has gone", within_s=180.0)
    shown = page.locator("#alert-list .alert").filter(has_text=alert["message"])
    expect(shown).to_contain_text(re.compile("ended", re.IGNORECASE))
    writes(page, "POST", f"{key}/acknowledge", {})
    expect(shown).to_have_count(0)


def returning_and_abort_reach_one_mission(page: Page, south: Flown, north: Flown) -> None:
    """Return of all by the page, then landing and abort by the API."""
    opened(page, f"/missions/{north.mission}/fly")
    before = {name: commands_of(page, uav) for name, uav in south.uavs.items()}
    crashed = page.locator("#alert-list .alert").filter(has_text="crashed")
    crashed.get_by_role("button", name="Copy position").click()
    expect(page.locator("#toasts")).to_contain_text(re.compile(r"\d+\.\d{5}° [NS], \d+\.\d{5}° [EW]"))
    page.get_by_role("button", name="Return all").click()
    question = page.get_by_role("dialog", name=re.compile(r"^Return all \d UAVs\?$"))
    for name in south.uavs:
        expect(question).not_to_contain_text(name)
    question.locator(".acts button").last.click()  # the return, or what is safer than it
    for name in ("Rook", "Swift"):
        until(page, lambda name=name: commands_of(page, north.uavs[name])[-1] != "start", f"{name} is given its return")
    writes(page, "POST", f"/missions/{north.mission}/commands", {"kind": "land"})
    writes(page, "POST", f"/missions/{north.mission}/abort", {"why": "The day is over."})
    assert asks(page, f"/missions/{north.mission}")["state"] == "aborted"
    assert {name: commands_of(page, uav) for name, uav in south.uavs.items()} == before


def blind_pages_blame_no_uav(visitor: Visitor, site: Site, north: Flown) -> None:
    for size in ((1440, 900), (390, 844)):
        for fault in ("cut", "freeze"):
            page = visitor.signs_in("opal", size=size, touch=size[0] < 500)
            with line_to(site.address) as line:
                address = line.address
                page.goto(f"{address}/missions/{north.mission}/fly")
                expect(page.locator("html[data-loaded][data-link=whole]")).to_be_attached()
                lost = page.get_by_text("nobody can say where it is now").count()
                page.evaluate(NOTES_WHEN_IT_IS_SHOWN)
                began_s = time.time()
                getattr(line, fault)()
                expect(page.locator("#stale")).to_contain_text("No data on this device for 5 s.", timeout=15_000)
                took_s = page.evaluate("window.shownAt") / 1_000 - began_s
                page.wait_for_timeout(8_000)
                assert page.get_by_text("nobody can say where it is now").count() <= lost, (size, fault)
                line.repair()
            page.context.close()
            visitor.complaints.clear()
            visitor.requests_outside[:] = [url for url in visitor.requests_outside if not url.startswith(address)]
            assert took_s <= STALE_S, (size, fault, took_s)
            print(f"{size[0]} px, {fault}: told after {took_s:.1f} s")
