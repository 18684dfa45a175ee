"""The 3D view's pictures for the documentation: to a tower, along a line, round a zone, landing, two UAVs, at night, on a phone."""

import re
from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Site, Visitor
from tests.browser.flying.test_report import VIEWS, flown, posts
from tests.browser.operator_map import asks, unlimited_type
from tests.browser.regions import region
from tests.browser.scene.test_scene import TIMEOUT_MS, seen
from tests.browser.test_fleet import writes

__all__ = ["flown"]
pytestmark = [pytest.mark.browser, pytest.mark.long]

Picture = Callable[[Page, str], None]
Towers = dict[int, dict[str, Any]]
BUILD_GRAPH = "from django.core.management import call_command; call_command('build_graph')"
REHEARSES_S = 300
BOTH_THEMES = {"approach", "line"}
DAY = (datetime.now(UTC) + timedelta(days=20)).date()
DAYTIME, NIGHT = f"{DAY}T{region.afternoon_utc}:00+00:00", f"{DAY}T{region.night_utc}:00+00:00"


@pytest.fixture
def towers(visitor: Visitor) -> Towers:
    """Of one line, by their number in it."""
    page = visitor.signs_in("ada")
    found = asks(page, f"/assets?kind=tower&bbox={region.picture_towers}&limit=400")["features"]
    page.close()
    numbers = [re.fullmatch(region.picture_line, tower["properties"]["label"]) for tower in found]
    return {int(number[1]): tower for number, tower in zip(numbers, found, strict=True) if number}


@pytest.fixture
def zone(visitor: Visitor, site: Site, towers: Towers) -> Iterator[str]:
    """A low one across the line, with a network that knows it; taken away afterwards."""
    page = visitor.signs_in("ada")
    lon, lat = towers[8]["geometry"]["coordinates"]
    circle, low = {"centre": [lon + 0.0006, lat], "radius_m": 150}, {"value_m": 75, "reference": "AGL"}
    made = posts(page, "/zones", {"name": "Works at the crossing", "circle": circle, "upper_limit": low})
    site.does(BUILD_GRAPH)
    yield made["properties"]["name"]
    writes(page, "DELETE", f"/zones/{made['id']}", None)
    site.does(BUILD_GRAPH)


def beside(tower: dict[str, Any], east_deg: float = 0.0009, north_deg: float = 0.0012) -> list[float]:
    lon, lat = tower["geometry"]["coordinates"]
    return [lon + east_deg, lat + north_deg]


def rehearsed(page: Page, name: str, uavs: dict[str, list[float]], targets: list[dict[str, Any]], departs_at: str, most: int) -> str:
    """The key of a mission that is planned and rehearsed as planned."""
    ids = [
        posts(page, "/uavs", {"name": uav, "position": place, "is_simulated": True, "type": unlimited_type(page)})["id"]
        for uav, place in uavs.items()
    ]
    body = {
        "name": name, "uavs": [{"id": uav, "most_targets": most} for uav in ids],
        "targets": [{"asset": target["id"]} for target in targets],
        "return_to_start": True, "plan": True, "departs_at": departs_at,
        "conditions": {"wind": [{"altitude_agl_m": 10, "speed_mps": 5.0, "from_deg": 240}], "temperature_c": 12},
    }  # fmt: skip
    mission = str(posts(page, "/missions", body)["id"])
    rehearsal = posts(page, f"/missions/{mission}/rehearsals", {"conditions": ["as-planned"]})["id"]
    for _ in range(REHEARSES_S):
        if asks(page, f"/missions/{mission}/rehearsals/{rehearsal}")["state"] not in {"queued", "running"}:
            break
        page.wait_for_timeout(1_000)
    return mission


def reached_s(page: Page, mission: str) -> list[list[float]]:
    """For each UAV the seconds after departure at which it reached its targets in the rehearsal, in the order of time."""
    rehearsal = asks(page, f"/missions/{mission}/rehearsals")["results"][0]["id"]
    assessment = asks(page, f"/missions/{mission}/rehearsals/{rehearsal}")["runs"][0]["assessment"]
    return [sorted(target["at_s"] for target in route["targets"] if target["at_s"] is not None) for route in assessment["routes"]]


def ends_s(page: Page, mission: str, uav: int = 0) -> float:
    rehearsal = asks(page, f"/missions/{mission}/rehearsals")["results"][0]["id"]
    track = asks(page, f"/missions/{mission}/rehearsals/{rehearsal}/track?run=0")
    return float(track["routes"][uav]["flights"][-1]["t_s"][-1])


def at(departs_at: str, seconds: float) -> str:
    return (datetime.fromisoformat(departs_at) + timedelta(seconds=seconds)).strftime("%Y-%m-%dT%H:%M:%S.000Z")


def looks(page: Page, picture: Picture, address: str, name: str) -> None:
    seen(page, address)
    expect(page.get_by_role("region", name="Instruments")).to_be_visible()
    page.wait_for_timeout(1_500)  # for documentation alone: shadows and labels settle
    picture(page, name)


def test_flights_among_towers(visitor: Visitor, towers: Towers, picture: Picture) -> None:
    page = visitor.signs_in("ada")
    uavs = {"Scaup": beside(towers[2]), "Smew": beside(towers[12])}
    key = rehearsed(page, "Line 40, both ways", uavs, [towers[number] for number in (4, 12, 3, 11)], DAYTIME, 2)
    first, last = reached_s(page, key)[0][0], reached_s(page, key)[0][-1]
    landing = ends_s(page, key) - 12
    base = f"/missions/{key}/3d?source=rehearsal&t="
    views = {
        "approach": (first - 16, "uav=0&camera=chase&view=-28,18,9"),
        "line": ((first + last) / 2, "uav=0&camera=chase&view=35,24,22"),
        "two": ((first + last) / 2, "uav=1&camera=orbit&view=150,22,520"),
        "target": (first - 1, "uav=0&camera=orbit&view=200,12,120"),
        "onboard": (first - 5, "uav=0&camera=onboard&view=0,-18,0"),
        "landing": (landing, "uav=0&camera=chase&view=40,16,12"),
        "top": (first + 4, "camera=top&view=0,90,900"),
    }
    for theme in ("light", "dark"):
        page = visitor.signs_in("vera", **VIEWS[theme])
        for name, (moment_s, rest) in views.items():
            if theme == "light" or name in BOTH_THEMES:
                looks(page, picture, f"{base}{at(DAYTIME, moment_s)}&{rest}", f"scene-{name}-{theme}")
    for view, camera in (("phone-light", "chase&view=-28,20,13"), ("phone-dark", "orbit&view=200,12,150")):
        page = visitor.signs_in("vera", **VIEWS[view])
        looks(page, picture, f"{base}{at(DAYTIME, first - 15)}&uav=0&camera={camera}", f"scene-{view}")


def test_round_a_zone_and_at_night(visitor: Visitor, towers: Towers, zone: str, picture: Picture) -> None:
    page = visitor.signs_in("ada")
    targets = [towers[5], towers[11]]
    night = rehearsed(page, "Night patrol", {"Pratincole": beside(towers[4])}, targets, NIGHT, 2)
    day = rehearsed(page, "Round the works", {"Phalarope": beside(towers[4])}, targets, DAYTIME, 2)
    at_tower = reached_s(page, night)[0][0] - 1
    between = sum(reached_s(page, day)[0]) / 2
    for theme in ("light", "dark"):
        page = visitor.signs_in("vera", **VIEWS[theme])
        night_at = f"/missions/{night}/3d?source=rehearsal&t={at(NIGHT, at_tower)}"
        looks(page, picture, f"{night_at}&camera=orbit&view=215,14,110", f"scene-night-{theme}")
        day_at = f"/missions/{day}/3d?source=rehearsal&t={at(DAYTIME, between)}"
        looks(page, picture, f"{day_at}&camera=chase&view=40,28,330", f"scene-zone-{theme}")
    expect(page.locator("[data-reading=zone]")).to_contain_text(zone, timeout=TIMEOUT_MS)


def test_a_record_with_an_estimate(visitor: Visitor, flown: str, picture: Picture) -> None:
    address = re.sub("report$", "3d", flown)
    for theme in ("light", "dark"):
        page = visitor.signs_in("vera", **VIEWS[theme])
        looks(
            page,
            picture,
            f"{address}?source=record&t=2026-09-10T09:14:40.000Z&uav=0&camera=chase&view=30,24,70",
            f"scene-estimated-{theme}",
        )
    expect(page.locator(".scene-certainty")).to_contain_text("estimated", timeout=TIMEOUT_MS)
