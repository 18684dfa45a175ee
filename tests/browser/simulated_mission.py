"""A small mission for simulated UAVs: towers that can be clicked, UAVs that stand beside them, and what is pressed on its pages."""

import math
import re
import time
from collections.abc import Callable
from typing import Any

from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, unlimited_type, wait_for_map
from tests.browser.regions import region
from tests.browser.test_fleet import writes

APART_M, FROM_M = (150.0, 900.0), 250.0  # of the two towers; of a UAV from the first one
FLIGHT_MS = 240_000  # a machine that has much else to do flies slower than it was told
SOON_MS, SOON_S = 60_000, 90.0
DEGREE_M = 111_195.0
CONFLICT = 409


def away_m(a: list[float], b: list[float]) -> float:
    return math.hypot((b[0] - a[0]) * DEGREE_M * math.cos(math.radians(a[1])), (b[1] - a[1]) * DEGREE_M)


def two_towers(page: Page) -> list[dict[str, Any]]:
    """Two that stand alone enough to be clicked, and near each other."""
    found = asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=200")["features"]
    places = [tower["geometry"]["coordinates"] for tower in found]
    uavs = [uav["geometry"]["coordinates"] for uav in asks(page, "/uavs?limit=200")["features"]]  # of other tests, which a click would take
    alone = [tower for tower, at in zip(found, places, strict=True) if sum(away_m(at, other) < 60.0 for other in places + uavs) == 1]
    for tower in alone:
        for other in alone:
            if APART_M[0] <= away_m(tower["geometry"]["coordinates"], other["geometry"]["coordinates"]) <= APART_M[1]:
                return [tower, other]
    raise AssertionError("no two towers stand like that")


def beside(place: list[float], number: int = 0) -> list[float]:
    """Where a UAV stands: to the east, each a little farther north."""
    return [place[0] + FROM_M / (DEGREE_M * math.cos(math.radians(place[1]))), place[1] + number * 0.0006]


def simulated_uavs(page: Page, *names: str, at: list[float], **more: Any) -> list[int]:
    """Of the fleet, as an administrator makes them."""
    return [
        writes(
            page,
            "POST",
            "/uavs",
            {
                "name": name,
                "position": beside(at, number),
                "is_simulated": True,
                "type": unlimited_type(page),
                "cruise_speed_mps": 10.0,
                **more,
            },
        )["id"]
        for number, name in enumerate(names)
    ]


def has_nothing_open(page: Page, uav: int) -> bool:
    newest = asks(page, f"/uavs/{uav}/commands?limit=20")["results"]
    return all(one["state"] not in {"queued", "sent", "acknowledged"} for one in newest)


def until(page: Page, fact: Callable[[], Any], words: str, within_s: float = SOON_S) -> Any:
    """What is found, once it is."""
    until_s = time.monotonic() + within_s
    while time.monotonic() < until_s:
        if found := fact():
            return found
        page.wait_for_timeout(500)
    raise AssertionError(f"not within {within_s:.0f} s: {words}")


def retires(page: Page, uavs: list[int]) -> None:
    """They are not offered to other tests' missions."""
    for uav in uavs:
        for simulation in asks(page, "/simulations")["results"]:
            if any((vehicle["uav"] or {}).get("id") == uav for vehicle in simulation["vehicles"]):
                writes(page, "DELETE", f"/simulations/{simulation['id']}")
        writes(page, "PATCH", f"/uavs/{uav}", {"state": "retired", "name": f"Simulated {uav}"})


def stores_simulated_mission(page: Page, name: str, uavs: list[int], towers: list[dict[str, Any]], *, approved: bool = True) -> str:
    """Planned, and approved if so wanted; its key."""
    body = {
        "name": name, "uavs": [{"id": uav, "most_targets": math.ceil(len(towers) / len(uavs))} for uav in uavs],
        "targets": [{"asset": tower["id"]} for tower in towers], "objective": "makespan", "return_to_start": True, "plan": True,
    }  # fmt: skip
    key = str(writes(page, "POST", "/missions", body)["id"])
    if approved:
        writes(page, "POST", f"/missions/{key}/approve")
    return key


def opened(page: Page, path: str) -> Page:
    page.goto(path)
    wait_for_map(page)
    return page


def answers(page: Page, act: str) -> None:
    """The question that is open, with the button of that name."""
    page.get_by_role("dialog").get_by_role("button", name=act, exact=True).click()
    expect(page.get_by_role("dialog")).to_have_count(0)


def panel_of(page: Page) -> Any:
    """The drawer, which is folded until somebody opens it."""
    panel = page.get_by_role("region", name="Simulation")
    if panel.locator("details:not([open])").count():
        panel.locator("summary").click()
    return panel


def flies_in_simulation(page: Page, speed: str) -> None:
    """From the page of its flight: starts the stand-ins, and waits until they stand there."""
    panel = panel_of(page)
    panel.get_by_role("combobox", name="Speed").select_option(label=speed)
    panel.get_by_role("button", name="Fly in simulation").click()
    expect(panel.locator(".simulation-uavs")).to_contain_text("on the ground", timeout=SOON_MS)


def card(page: Page, name: str) -> Any:
    return page.locator("#uav-cards .card").filter(has=page.get_by_role("button", name=re.compile(name)))


def starts(visitor: Visitor, page: Page, name: str) -> None:
    """Alone, by the menu of its commands; also where its slot is later."""
    card(page, name).get_by_role("button", name=re.compile(name)).click()
    page.get_by_role("group", name=f"Commands to {name}").get_by_role("button", name="More").click()
    page.locator(".menu").get_by_role("button", name="Start", exact=True).click()
    with page.expect_response(lambda response: response.request.method == "POST") as answered:
        page.get_by_role("dialog").get_by_role("button", name=f"Start {name}").click()
    if answered.value.status == CONFLICT:
        outside = page.get_by_role("dialog", name=f"Start {name} outside its slot?")
        outside.get_by_role("button", name=f"Start {name} all the same").click()
    expect(page.get_by_role("dialog")).to_have_count(0)
    visitor.complaints[:] = [words for words in visitor.complaints if "409 (Conflict)" not in words]
