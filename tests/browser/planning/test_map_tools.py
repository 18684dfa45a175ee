"""What the map offers to look with: tooltips, layers, measuring, coordinates, places to go to, and what is said when it cannot be read."""

import math
import re
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, Route, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, look_at, targets, unlimited_type, wait_for_map
from tests.browser.regions import HELIPORT, METRES_PER_DEG, region

pytestmark = pytest.mark.browser

AROUND = 0.01


def at_the_map(visitor: Visitor, name: str) -> Page:
    page = visitor.signs_in(name)
    page.goto("/missions/new")
    wait_for_map(page)
    return page


@pytest.fixture
def curator(visitor: Visitor) -> Page:
    return at_the_map(visitor, "cora")


@pytest.fixture
def operator(visitor: Visitor) -> Page:
    return at_the_map(visitor, "opal")


def draws_zone(page: Page, name: str, **facts: Any) -> int:
    """A square zone in an empty place, made through the API with the page's session. Its number."""
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    [west, south], [east, north] = [[degrees + side * AROUND for degrees in region.empty] for side in (-1, 1)]
    square = {"type": "Polygon", "coordinates": [[[west, south], [east, south], [east, north], [west, north], [west, south]]]}
    answer = page.request.post("/api/v1/zones", data={"name": name, "geometry": square, **facts}, headers={"X-CSRFToken": token})
    assert answer.status == 201, answer.text()
    return int(answer.json()["id"])


def removes_zone(page: Page, number: int) -> None:
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    answer = page.request.delete(f"/api/v1/zones/{number}", headers={"X-CSRFToken": token, "If-Match": '"1"'})
    assert answer.ok, answer.text()


def opens_at(page: Page, position: list[float], zoom: float) -> dict[str, float]:
    """The page anew, with the tiles of now, at a place; where that is on the screen."""
    page.goto("about:blank")
    page.goto("/missions/new")
    wait_for_map(page)
    return look_at(page, position, zoom)


def test_a_zone_under_the_pointer_tells_its_heights_times_source_and_whether_it_is_in_force(curator: Page) -> None:
    number = draws_zone(
        curator,
        "Heron colony",
        reason="Breeding season",
        lower_limit={"value_m": 0, "reference": "AGL"},
        upper_limit={"value_m": 120, "reference": "AGL"},
        schedule=[{"startDateTime": None, "endDateTime": "2020-06-01T00:00:00Z", "schedule": []}],
    )
    try:
        place = opens_at(curator, region.empty, 14)
        curator.mouse.move(place["x"] + 20, place["y"] + 20)
        tip = curator.get_by_role("tooltip")
        expect(tip).to_contain_text("Heron colony")
        expect(tip).to_contain_text(re.compile(r"From ground to 120\sm above ground"))
        expect(tip).to_contain_text("until")
        expect(tip).to_contain_text("Not in force now")
        expect(tip).to_contain_text("Breeding season")
        expect(tip).to_contain_text("Drawn in Spanwise, changed now")
        expect(tip).to_contain_text("A plan with a departure counts it at its times, any other plan at all times.")
        expect(tip.locator("svg").first).to_be_visible()
        curator.keyboard.press("Escape")
        expect(tip).to_be_hidden()

        legend = curator.get_by_role("list", name="Legend")
        expect(legend).to_contain_text("No-fly zone, not in force now")
        curator.get_by_role("button", name="Layers").click()
        curator.get_by_label("Also zones not in force now").uncheck()
        expect(legend.filter(has_text="not in force now")).to_have_count(0)
        curator.mouse.move(place["x"] + 24, place["y"] + 24)
        expect(tip).to_be_hidden()
    finally:
        removes_zone(curator, number)


@pytest.mark.long
def test_layers_go_by_kind_and_voltage_and_it_is_said_that_some_are_hidden(operator: Page, picture: Callable[[Page, str], None]) -> None:
    line = asks(operator, f"/assets?kind=line&text={region.voltage_kv}&limit=1")["features"][0]
    look_at(operator, line["properties"]["centre"], 13)
    legend = operator.get_by_role("list", name="Legend")
    expect(legend).to_contain_text("100 to 199 kV")
    operator.get_by_role("button", name="Layers").click()
    menu = operator.get_by_role("group", name="Layers")
    menu.get_by_label("100 to 199 kV").uncheck()
    expect(legend).not_to_contain_text("100 to 199 kV")
    expect(operator.get_by_role("button", name="Layers: some are hidden")).to_be_visible()
    menu.get_by_label("Railways").uncheck()
    picture(operator, "map-layers")
    expect(legend).not_to_contain_text("Railway")
    menu.get_by_role("button", name="Show everything").click()
    expect(legend).to_contain_text("100 to 199 kV")
    expect(operator.get_by_role("button", name="Layers", exact=True)).to_be_visible()
    expect(menu.get_by_label("Railways")).to_be_checked()
    operator.keyboard.press("Escape")
    expect(menu).to_have_count(0)


@pytest.mark.long
def test_distances_are_measured_with_the_mouse_and_nothing_is_picked_meanwhile(operator: Page) -> None:
    place = look_at(operator, region.empty, 14)
    operator.get_by_role("button", name="Measure").click()
    banner = operator.get_by_role("group", name="Measuring")
    expect(banner).to_contain_text("Click where to measure from")
    a_kilometre = operator.evaluate(  # and a little, or it would be told in metres
        "([x, y, east]) => { const map = document.getElementById('map'); return map.project([x + east, y]).x - map.project([x, y]).x; }",
        [*region.empty, 1003 / (METRES_PER_DEG * math.cos(math.radians(region.empty[1])))],
    )
    operator.mouse.click(place["x"], place["y"])
    operator.mouse.click(place["x"] + a_kilometre, place["y"])
    expect(banner).to_contain_text(re.compile(r"1\.0\skm · 090°"))
    operator.mouse.click(place["x"] + a_kilometre, place["y"] - a_kilometre)
    expect(banner).to_contain_text(re.compile(r"2\.0\skm · last leg 1\.0\skm · 000° · area 0\.50\skm²"))
    banner.get_by_role("button", name="Remove the last point").click()
    expect(banner).to_contain_text(re.compile(r"1\.0\skm · 090°"))
    operator.keyboard.press("Escape")
    expect(banner).to_be_hidden()
    assert targets(operator) == []


def test_distances_are_measured_with_the_keyboard_alone(operator: Page) -> None:
    look_at(operator, region.empty, 14)
    operator.keyboard.press("m")
    banner = operator.get_by_role("group", name="Measuring")
    operator.get_by_role("region", name="Map").locator("canvas").focus()
    operator.keyboard.press("Enter")
    expect(banner).to_contain_text("Click the next point.")
    operator.evaluate("delete document.getElementById('map').dataset.idle")
    operator.keyboard.press("ArrowRight")
    operator.locator("#map[data-idle]").wait_for(state="attached")
    operator.keyboard.press("Enter")
    expect(banner).to_contain_text(re.compile(r"\d\s(km|m) · 090°"))
    operator.keyboard.press("Backspace")
    expect(banner).to_contain_text("Click the next point.")
    operator.keyboard.press("m")
    expect(banner).to_be_hidden()


@pytest.mark.long
def test_the_coordinates_of_a_place_are_copied_latitude_first(operator: Page) -> None:
    operator.context.grant_permissions(["clipboard-read", "clipboard-write"])
    place = look_at(operator, region.empty, 14)
    operator.mouse.click(place["x"], place["y"], button="right")
    operator.get_by_role("button", name="Copy the coordinates").click()
    copied = [float(part) for part in operator.evaluate("navigator.clipboard.readText()").split(", ")]
    assert copied == pytest.approx([region.empty[1], region.empty[0]], abs=1e-4)
    expect(operator.get_by_text(re.compile(f"^Copied: {str(region.empty[1])[:4]}"))).to_be_visible()


@pytest.mark.long
@pytest.mark.parametrize("words", ["39.9612, -82.9988", "39°57'40.3\"N 82°59'55.7\"W"])
def test_coordinates_in_the_search_box_are_gone_to(operator: Page, words: str) -> None:
    find = operator.get_by_role("combobox", name="Find an asset or a line")
    find.fill(words)
    expect(operator.get_by_role("listbox").get_by_role("option").first).to_contain_text("39.9612, −82.9988")
    find.press("Enter")
    expect(operator).to_have_url(re.compile(r"#map=[\d.]+/39\.961\d*/-82\.998\d*$"))


@pytest.mark.long
def test_a_zone_is_found_by_name_and_gone_to(operator: Page) -> None:
    operator.get_by_role("combobox", name="Find an asset or a line").fill("Meadow")
    operator.get_by_role("listbox").get_by_role("option", name=HELIPORT).click()
    expect(operator).to_have_url(re.compile(r"#map=1[2-6][\d.]*/[\d.]+/-?[\d.]+$"))
    latitude, longitude = map(float, operator.url.split("/")[-2:])
    assert [longitude, latitude] == pytest.approx(region.heliport, abs=0.01)


def test_tiles_that_cannot_be_read_are_told_and_asked_for_again(visitor: Visitor, operator: Page) -> None:
    def away(route: Route) -> None:
        route.abort()

    operator.route("**/api/v1/tiles/**", away)
    look_at(operator, region.at(0.1, 0.04), 15)
    notice = operator.get_by_text("The map cannot be read.")
    expect(notice).to_be_visible()
    operator.unroute("**/api/v1/tiles/**", away)
    operator.get_by_role("button", name="Try now").click()
    expect(notice).to_be_hidden()
    received = [complaint for complaint in visitor.complaints if "ERR_FAILED" not in complaint and not complaint.startswith("map: ")]
    assert received == []
    visitor.complaints.clear()


@pytest.mark.long
def test_with_a_finger_a_zone_tells_the_same(visitor: Visitor) -> None:
    page = visitor.signs_in("opal", size=(390, 844), touch=True)
    page.goto("/missions/new")
    wait_for_map(page)
    place = look_at(page, region.in_heliport, 14)
    page.touchscreen.tap(place["x"], place["y"])
    expect(page.get_by_role("tooltip")).to_contain_text(HELIPORT)


@pytest.mark.long
def test_a_uav_points_along_its_heading_and_nowhere_without_one(operator: Page) -> None:
    token = next(cookie["value"] for cookie in operator.context.cookies() if cookie["name"] == "csrftoken")
    of, east = unlimited_type(operator), [region.empty[0] + 0.05, region.empty[1]]
    for name, place, more in (
        ("Heading dart", region.empty, {"heading_deg": 90}),
        ("Heading unknown", east, {}),
        ("Heading unknown 2", east, {}),
    ):
        answer = operator.request.post(
            "/api/v1/uavs", data={"name": name, "position": place, "type": of, **more}, headers={"X-CSRFToken": token}
        )
        assert answer.status == 201, answer.text()
    opens_at(operator, region.empty, 12)
    map_region = operator.get_by_role("region", name="Map")
    dart = map_region.get_by_role("button", name="Heading dart, not in this mission, heading 090°")
    expect(dart.locator("svg")).to_have_css("rotate", "90deg")
    both = map_region.get_by_role("button", name="2 UAVs, not in this mission: Heading unknown, Heading unknown 2")
    both.click()
    expect(map_region.get_by_role("button", name="Heading unknown, not in this mission", exact=True).locator("svg circle")).to_be_visible()
    map_region.get_by_role("button", name="Heading unknown 2, not in this mission", exact=True).click()
    expect(operator.get_by_role("checkbox", name="Heading unknown 2")).to_be_checked()
