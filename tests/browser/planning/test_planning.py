"""Planning: whom to send, both ways of planning side by side, the flight from the side, why, and against the last plan."""

import re
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, place_of, wait_for_map
from tests.browser.regions import region

pytestmark = pytest.mark.browser


def sends(page: Page, path: str, body: dict[str, Any]) -> Any:
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    answer = page.request.post(f"/api/v1/{path}", data=body, headers={"X-CSRFToken": token})
    assert answer.ok, answer.text()
    return answer.json()


def opens_mission(
    page: Page, name: str, *, targets: int = 8, more: list[dict[str, Any]] | None = None, box: str = region.all_towers
) -> None:
    """A planned mission with two UAVs that start apart, and towers around both."""
    towers = asks(page, f"/assets?kind=tower&bbox={box}&limit=200")["features"]
    picked = towers[:: max(1, len(towers) // targets)][:targets]
    uavs = [{"name": "Heron", "position": region.west}, {"name": "Kite", "position": region.east}]
    wanted = [{"asset": tower["id"]} for tower in picked] + (more or [])
    options = {"objective": "makespan", "return_to_start": True, "plan": targets <= 12}
    mission = sends(page, "missions", {"name": name, "uavs": uavs, "targets": wanted, **options})
    page.goto(f"/missions/{mission['id']}")
    wait_for_map(page)


def objective(page: Page, name: str) -> Any:
    return page.get_by_role("radio", name=name)


@pytest.mark.long
def test_both_ways_of_planning_stand_side_by_side_and_one_click_switches(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "Two ways", more=[{"position": region.far_away}])
    facts = page.locator("#plan-facts")
    even, least = (
        page.locator("#objective label").filter(has_text="Finish soonest"),
        page.locator("#objective label").filter(has_text="Shortest distance"),
    )
    expect(even).to_contain_text(re.compile(r"\d+\smin, \d+\.\d\skm"))
    expect(least).to_contain_text(re.compile(r"\d+\smin, \d+\.\d\skm"))
    figures = {name: (label.text_content() or "").split(", ")[1] for name, label in (("even", even), ("least", least))}
    expect(facts).to_contain_text(figures["even"])

    objective(page, "Shortest distance").focus()
    page.keyboard.press("Space")
    expect(facts).to_contain_text(figures["least"])
    expect(facts).not_to_contain_text("for the selection before")
    page.keyboard.press("Control+z")
    expect(objective(page, "Finish soonest")).to_be_checked()
    expect(facts).to_contain_text(figures["even"])


@pytest.mark.long
def test_a_strip_the_profile_and_the_map_follow_one_pointer(visitor: Visitor, picture: Callable[[Page, str], None]) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "From the side")
    profile = page.locator("#route-profile")
    drawing = profile.get_by_role("img")
    expect(drawing).to_have_attribute("aria-label", re.compile(r"flies \d+\sm to \d+\sm above"))
    row = page.get_by_role("list", name="Routes").get_by_role("listitem").nth(1)
    strip = row.get_by_role("img").first
    box = strip.bounding_box()
    assert box
    page.mouse.move(box["x"] + box["width"] * 0.4, box["y"] + 18)
    expect(row).to_have_class(re.compile("lit"))
    expect(drawing).to_have_attribute("aria-label", re.compile("^Kite flies"))  # the profile is that row's
    expect(profile).to_contain_text(re.compile(r"at \d+\.\d\skm"))
    expect(profile).to_contain_text(re.compile(r"\d+\sm above (take-off|sea level)"))
    expect(strip.locator(".strip-cursor")).to_have_attribute("visibility", "visible")
    chart = drawing.bounding_box()
    assert chart and abs(chart["x"] - box["x"]) < 1  # one axis
    picture(page, "plan-profile")
    page.emulate_media(color_scheme="dark")
    picture(page, "plan-profile-dark")
    page.emulate_media(color_scheme="light")

    page.mouse.move(0, 0)
    expect(profile).not_to_contain_text(re.compile(r"at \d+\.\d\skm"))
    page.locator("#target-list .what").first.hover()
    expect(page.locator(".strip-target.lit")).to_have_count(1)
    name = row.get_by_role("button", name=re.compile("^B Kite"))
    name.click()
    expect(name).to_have_attribute("aria-pressed", "true")
    page.mouse.move(0, 0)
    expect(drawing).to_have_attribute("aria-label", re.compile("^Kite flies"))  # a chosen route stays
    page.keyboard.press("Escape")


def test_a_target_that_is_not_reached_says_why_and_what_would_help(visitor: Visitor, picture: Callable[[Page, str], None]) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "Too far", more=[{"position": region.far_away}])
    notice = page.locator("#notices .notice").filter(has_text="is not reached")
    expect(notice).to_contain_text("It is more than 10 km from the network.")
    expect(page.locator("#mission-state")).to_have_text("Partly planned, 8 of 9")
    notice.get_by_role("button", name="Why?").click()
    why = page.get_by_role("complementary", name=re.compile("Why .* is not reached"))
    expect(why).to_contain_text(re.compile(r"The nearest line, railway or bridge is \d+\.\d\skm away"))
    expect(why.get_by_role("row").filter(has_text="Heron")).to_contain_text("no way")
    picture(page, "plan-why-light")
    why.get_by_role("button", name="Remove it").click()
    expect(page.locator("#target-list .target")).to_have_count(8)
    expect(why).to_be_hidden()


@pytest.mark.long
def test_a_route_says_where_its_kilometres_come_from(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "Why this way")
    opener = page.get_by_role("button", name="Why does Kite fly this route?")
    opener.focus()
    strips = page.locator("#route-list .strip-place")
    widths = [strip.bounding_box()["width"] for strip in strips.all()]  # type: ignore[index]
    page.keyboard.press("Enter")
    why = page.get_by_role("complementary", name="Why Kite flies this way")
    expect(why.get_by_role("heading", name="Why Kite flies this way")).to_be_focused()
    assert [strip.bounding_box()["width"] for strip in strips.all()] == widths, "reasons take the profile's place"  # type: ignore[index]
    assert all(row.bounding_box()["height"] <= 32 for row in page.locator("#route-list .route").all())  # type: ignore[index]
    expect(page.locator("#route-list .length-figure").first).to_be_visible()
    expect(why).to_contain_text("Straight from target to target")
    expect(why).to_contain_text("Limiting factor:")
    expect(why).to_contain_text(re.compile(r"Giving .* to Heron (would|is not possible)"))
    page.keyboard.press("Escape")
    expect(why).to_be_hidden()
    expect(opener).to_be_focused()


@pytest.mark.long
def test_a_plan_is_set_against_the_last_one(visitor: Visitor, picture: Callable[[Page, str], None]) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "Against the last")
    page.get_by_role("switch", name="Return to start").click()
    page.locator("#target-list .what").first.focus()
    page.keyboard.press("Delete")
    expect(page.locator("#target-list .target")).to_have_count(7)
    page.keyboard.press("p")
    expect(page.locator("#plan-facts")).to_contain_text("all 7 targets")
    page.get_by_role("button", name="Compare with the last plan").click()
    compared = page.get_by_role("complementary", name="Against the last plan")
    expect(compared).to_contain_text(re.compile(r"(less|more|sooner|later|As long).*\d target"))
    heron = compared.get_by_role("row").filter(has_text="Heron")
    expect(heron).to_contain_text("km")
    expect(heron).to_contain_text("ends hovering at its last target instead of at its start")
    expect(compared.get_by_role("list", name="Targets that have changed")).to_contain_text("not in the mission")
    expect(page.locator(".strip.pale").first).to_be_visible()
    picture(page, "plan-compare")
    page.get_by_role("button", name="Close", exact=True).click()
    expect(compared).to_be_hidden()
    expect(page.locator(".strip.pale")).to_have_count(0)


@pytest.mark.long
def test_a_uav_that_is_dragged_starts_elsewhere(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "Another start")
    square = page.get_by_role("button", name="Heron starts here")
    box = square.bounding_box()
    assert box
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 60, box["y"] + 40, steps=5)
    page.mouse.up()
    expect(page.locator("#mission-facts")).to_contain_text("changed since it was planned")
    moved = square.bounding_box()
    assert moved and moved["x"] > box["x"] + 30
    was = place_of(page, region.west)
    assert abs(moved["x"] + moved["width"] / 2 - was["x"]) > 30
    page.keyboard.press("Control+z")
    expect(page.locator("#mission-facts")).not_to_contain_text("changed since it was planned")


def test_a_long_plan_that_is_stopped_keeps_the_best_until_then(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "Many towers", targets=40)
    page.get_by_role("button", name="Plan P").click()
    expect(page.get_by_role("progressbar", name="Planning")).to_be_visible()
    stop = page.get_by_role("button", name="Stop, keep the best")
    expect(stop).to_be_visible()
    expect(page.locator("#job-how-far")).to_contain_text("so far")  # a first plan is found
    stop.click()
    expect(page.get_by_text("Stopped. The best plan so far is kept.")).to_be_visible()
    expect(page.get_by_role("list", name="Routes").get_by_role("listitem")).to_have_count(2)
    expect(page.locator("#plan-facts")).to_contain_text("40 targets")


@pytest.mark.long
def test_a_stored_plan_is_proven_in_the_background(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    towers = asks(page, f"/assets?kind=tower&bbox={region.all_towers}&limit=200")["features"]
    picked = [{"asset": tower["id"]} for tower in towers[:: len(towers) // 16][:16]]
    uavs = [{"name": name, "position": place} for name, place in (("Wagtail", region.west), ("Dipper", region.east))]
    body = {"name": "To be proven", "targets": picked, "uavs": uavs, "objective": "total", "plan": True}
    mission = sends(page, "missions", body)
    page.goto(f"/missions/{mission['mission']}")
    quality = page.locator("#plan-quality")
    expect(quality).to_contain_text(re.compile("Proven shortest|Looking for a better plan"), timeout=60_000)
    expect(quality).to_contain_text("Proven shortest", timeout=120_000)
    expect(quality.get_by_role("button", name="Stop")).to_have_count(0)
    stored = asks(page, f"/missions/{mission['mission']}")
    assert (stored["plan"]["is_proven"], stored["plan"]["gap"]) == (True, 0.0)


@pytest.mark.long
def test_a_fleet_is_narrowed_by_sensor_and_base_and_several_are_chosen_at_once(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    kinds = {
        name: sends(page, "uav-types", {"name": name, "max_range_m": 30_000, "sensors": sensors})["id"] for name, sensors in KINDS.items()
    }
    bases = {
        name: sends(page, "bases", {"name": name, "position": place})["id"]
        for name, place in (("Gate west", region.west), ("Gate east", region.east))
    }
    for name, kind, base, state in FLEET:
        body = {"name": name, "position": region.west, "type": kinds[kind], "base": bases[base], "battery_percent": 95, "state": state}
        sends(page, "uavs", body)
    page.goto("/missions/new")
    wait_for_map(page)
    fleet = page.get_by_role("list", name="UAVs")
    box = fleet.get_by_role("checkbox", name="Sparrow 1")
    expect(box).not_to_be_checked()
    row = fleet.get_by_role("listitem").filter(has_text="Sparrow 1")
    expect(row).to_contain_text("95\u00a0%")
    expect(row).to_contain_text("range 30.0\u00a0km")
    expect(row).to_contain_text("Lidar of the test")
    expect(fleet).not_to_contain_text("Sparrow 5")  # retired
    expect(fleet.get_by_role("checkbox", name="Sparrow 4")).to_be_disabled()  # in maintenance

    page.get_by_role("combobox", name="Sensor", exact=True).select_option("Lidar of the test")
    expect(fleet.get_by_role("listitem")).to_have_count(2)
    page.get_by_role("combobox", name="Base", exact=True).select_option("Gate west")
    expect(fleet.get_by_role("listitem")).to_have_count(1)
    page.get_by_role("combobox", name="Base", exact=True).select_option("Every base")
    page.get_by_role("button", name="Select the remaining 2").click()
    expect(box).to_be_checked()
    expect(fleet.get_by_role("checkbox", name="Sparrow 2")).to_be_checked()
    page.locator("#map canvas").focus()
    page.keyboard.press("Control+z")
    expect(box).not_to_be_checked()


KINDS = {"Test quad": ["Lidar of the test"], "Test wing": ["Camera of the test"]}
FLEET = (
    ("Sparrow 1", "Test quad", "Gate west", "active"),
    ("Sparrow 2", "Test quad", "Gate east", "active"),
    ("Sparrow 3", "Test wing", "Gate west", "active"),
    ("Sparrow 4", "Test wing", "Gate east", "maintenance"),
    ("Sparrow 5", "Test wing", "Gate east", "retired"),
    ("Sparrow 6", "Test wing", "Gate east", "maintenance"),
    ("Sparrow 7", "Test wing", "Gate east", "maintenance"),
    ("Sparrow 8", "Test wing", "Gate east", "maintenance"),
    ("Sparrow 9", "Test wing", "Gate east", "maintenance"),
)
