"""When, in what air and with which batteries a mission is flown: options, results, legal times, ways to plan it, changes by hand, reach."""

import re
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, look_at, place_of, wait_for_map
from tests.browser.pictures import Picture, in_both_themes
from tests.browser.planning.test_planning import opens_mission
from tests.browser.planning.test_planning_options import PHONE, route
from tests.browser.regions import HELIPORT, region
from tests.browser.test_accessibility import faults
from tests.cases import long

pytestmark = pytest.mark.browser

DEPARTURE = "2027-03-02T09:30"


def mission_of(page: Page) -> dict[str, Any]:
    address = re.search("/missions/[0-9a-f-]+", page.url)
    assert address
    answer: dict[str, Any] = asks(page, address[0])
    return answer


def is_saved(page: Page) -> None:
    expect(page.locator("#save-state")).to_contain_text(re.compile(r"^Saved \d"))


def departure(page: Page) -> Locator:
    return page.get_by_role("textbox", name="Departure")


@pytest.mark.long
def test_departure_air_and_batteries_are_saved_and_undone_and_the_plan_shows_what_they_mean(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "In the wind", targets=4)
    expect(page.get_by_text("No departure time: all zones count as active.")).to_be_visible()
    page.get_by_role("button", name="Now", exact=True).click()
    expect(departure(page)).not_to_have_value("")
    page.get_by_role("button", name="Undo").first.click()
    expect(departure(page)).to_have_value("")
    departure(page).fill(DEPARTURE)
    expect(page.locator("#departure-words")).to_contain_text("Zones count at the times when the UAVs pass.")

    page.get_by_role("button", name="Change the conditions").click()
    dialog = page.get_by_role("dialog", name="Conditions")
    dialog.get_by_role("button", name="Add wind layer").click()
    dialog.get_by_label("Wind speed").fill("4")
    dialog.get_by_label(re.compile("^Wind from")).fill("90")
    dialog.get_by_label("Temperature").fill("5")
    assert faults(page) == []
    dialog.get_by_role("button", name="Apply").click()
    expect(page.get_by_text(re.compile(r"4\sm/s from the east at 100\sm, 5\s°C"))).to_be_visible()

    page.get_by_role("button", name="Change Kite in this mission").click()
    dialog = page.get_by_role("dialog", name="Kite")
    for label, value in (("Battery", "2500"), ("Kept in reserve", "25"), ("Mass at take-off", "8")):
        dialog.get_by_label(label, exact=True).fill(value)
    dialog.get_by_role("button", name="Change").click()
    is_saved(page)
    stored = mission_of(page)
    assert stored["departs_at"].startswith("2027-03-02T")
    assert stored["conditions"] == {"wind": [{"altitude_agl_m": 100.0, "speed_mps": 4.0, "from_deg": 90.0}], "temperature_c": 5.0}
    assert {name: stored["uavs"][1][name] for name in ("battery_wh", "reserve_percent", "mass_kg")} == {
        "battery_wh": 2500.0, "reserve_percent": 25.0, "mass_kg": 8.0,
    }  # fmt: skip

    page.get_by_role("button", name="Plan again").click()
    expect(route(page, "Kite")).to_contain_text(re.compile(r"until \d\d:\d\d"))
    expect(route(page, "Kite")).to_contain_text(re.compile(r"\d+\s% ?at landing"))
    expect(page.locator("#target-list .target-when").first).to_have_text(re.compile(r"^\d\d:\d\d$"))
    is_saved(page)
    in_both_themes(page, picture, "plan-battery")
    page.reload()
    wait_for_map(page)
    expect(departure(page)).to_have_value(DEPARTURE)
    expect(route(page, "Kite")).to_contain_text("at landing")
    page.get_by_role("button", name="Any time", exact=True).click()
    is_saved(page)
    assert mission_of(page)["departs_at"] is None


@pytest.mark.long
@pytest.mark.parametrize("how", [PHONE, *long({})], ids=["phone", "desk"])
def test_the_bar_of_legal_times_takes_a_departure_from_keys_and_from_a_click(
    visitor: Visitor, picture: Picture, how: dict[str, Any]
) -> None:
    page = visitor.signs_in("opal", **how)
    opens_mission(page, f"Legal on {how.get('theme', 'light')}", targets=3)
    if how:
        page.get_by_role("button", name="Panel height").click()
    page.get_by_role("button", name="When are the zones open?").click()
    dialog = page.get_by_role("dialog", name="When are the zones open?")
    expect(dialog).to_contain_text("Zones open throughout the next 48 hours.")
    slider = dialog.get_by_role("slider", name="Departure")
    expect(slider).to_have_attribute("aria-valuetext", "any time")
    slider.focus()
    page.keyboard.press("End")
    expect(slider).to_have_attribute("aria-valuetext", re.compile(", zones open$"))
    late = slider.get_attribute("aria-valuenow")
    expect(slider).to_be_focused()
    page.keyboard.press("Shift+ArrowLeft")
    expect(slider).not_to_have_attribute("aria-valuenow", late or "")
    dialog.get_by_role("button", name=re.compile("^Depart at the begin of")).click(position={"x": 90, "y": 12})
    expect(dialog).to_contain_text(re.compile(r"Departure .*: zones open\."))
    picture(page, f"plan-legal-{'phone-dark' if how else 'light'}")
    assert faults(page) == []
    page.keyboard.press("Escape")
    expect(departure(page)).not_to_have_value("")


@pytest.mark.long
def test_the_ways_of_planning_stand_side_by_side_and_one_click_takes_one(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "Four ways", targets=5)
    page.get_by_role("button", name="Compare", exact=True).click()
    panel = page.get_by_role("complementary", name="Ways to plan it")
    rows = panel.get_by_role("row")
    expect(rows.filter(has_text="Shortest distance")).to_contain_text(re.compile(r"\d\skm"))
    expect(rows.filter(has_text="Least flying time")).to_contain_text(re.compile(r"\d\skm"))
    expect(rows.filter(has_text="Least energy")).to_contain_text("No UAV states its battery’s capacity")
    expect(panel.locator("[aria-current]")).to_contain_text("Finish soonest")
    in_both_themes(page, picture, "plan-ways")
    assert faults(page) == []
    panel.get_by_role("button", name="Least flying time").click()
    expect(panel.locator("[aria-current]")).to_contain_text("Least flying time")
    expect(page.get_by_role("radio", name="Least flying time")).to_be_checked()
    expect(page.locator("#plan-facts")).not_to_contain_text("for the selection before")
    is_saved(page)
    assert mission_of(page)["objective"] == "time"


def test_a_route_is_changed_by_hand_on_the_map_and_by_keys_undone_and_kept(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "Drawn by hand", targets=3)
    is_saved(page)
    planned = mission_of(page)["plan"]["routes"][1]["waypoints"]
    free = [number for number, waypoint in enumerate(planned) if waypoint["kind"] == "pass"]
    dragged = free[len(free) // 2]
    page.get_by_role("button", name="Change the route of Kite by hand").click()
    panel = page.get_by_role("complementary", name="Change the route of Kite by hand")
    expect(panel).to_contain_text("Nothing is changed yet.")
    look_at(page, planned[dragged]["position"])
    place = place_of(page, planned[dragged]["position"])
    page.mouse.move(**place)
    page.mouse.down()
    page.mouse.move(place["x"] + 60, place["y"] + 30, steps=4)
    page.mouse.up()
    expect(panel).to_contain_text("1 waypoint is changed.")
    expect(panel).to_contain_text("The whole route is clear.")
    expect(panel.locator(".hand-figures")).to_contain_text(re.compile(r"km \(\+\d+\xa0m\)"))
    expect(page.locator("#profile-words")).to_contain_text(re.compile("Kite.*as changed by hand"))
    page.keyboard.press("Control+z")
    expect(panel).to_contain_text("Nothing is changed yet.")
    page.keyboard.press("Control+Shift+z")
    height = panel.get_by_label("Height above ground")
    height.fill("80")
    height.press("Tab")
    speed = panel.get_by_label("Speed on the way here")
    speed.fill("6")
    speed.press("Tab")
    expect(panel).to_contain_text("By hand; empty:")
    panel.get_by_role("button", name="Put one in after it").click()
    expect(panel).to_contain_text("2 waypoints are changed. The whole route is clear.")
    in_both_themes(page, picture, "plan-by-hand")
    assert faults(page) == []
    panel.get_by_role("button", name="Apply").click()
    expect(panel).to_be_hidden()
    expect(route(page, "Kite")).to_contain_text("changed by hand")
    kept = mission_of(page)["plan"]["routes"][1]
    assert len(kept["by_hand"]) >= 2
    assert max(kept["waypoints"][place]["altitude_agl_m"] for place in kept["by_hand"]) == 80.0
    assert {one["speed_mps"] for one in kept["speeds_by_hand"]} == {6.0}
    page.reload()
    page.get_by_role("button", name="Change the route of Kite by hand").click()
    expect(panel).to_contain_text("1 change by hand is kept and can be taken back.")
    panel.get_by_role("button", name="Take back the last change").click()
    expect(route(page, "Kite")).not_to_contain_text("changed by hand")
    assert mission_of(page)["plan"]["routes"][1]["waypoints"] == planned


@pytest.mark.long
def test_what_can_be_inspected_is_a_layer_with_counts_and_the_reason_of_each_asset(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "Within reach", targets=2)
    page.get_by_role("button", name="Layers", exact=True).click()
    page.get_by_role("checkbox", name="What can be inspected").check()
    page.keyboard.press("Escape")
    card = page.get_by_role("region", name="What can be inspected")
    expect(card).to_contain_text(re.compile(r"[\d,]+ of [\d,]+ assets can be inspected"))
    expect(card.get_by_role("list", name="Reasons")).to_contain_text(f"Inside {HELIPORT}.")
    in_both_themes(page, picture, "plan-reach")
    inside = asks(page, f"/assets?kind=bridge&bbox={region.heliport_bridges}&limit=1")["features"][0]
    place = look_at(page, inside["properties"]["centre"])
    page.mouse.move(place["x"] + 40, place["y"] + 40)
    page.mouse.move(place["x"], place["y"])
    expect(page.get_by_role("tooltip")).to_contain_text(f"Inside {HELIPORT}.")
    assert faults(page) == []
    page.get_by_role("button", name="Change Kite in this mission").click()
    page.get_by_role("dialog", name="Kite").get_by_label("Range").fill("3")
    page.get_by_role("dialog", name="Kite").get_by_role("button", name="Change").click()
    page.get_by_role("button", name="Change Heron in this mission").click()
    page.get_by_role("dialog", name="Heron").get_by_label("Range").fill("3")
    page.get_by_role("dialog", name="Heron").get_by_role("button", name="Change").click()
    expect(card.get_by_role("list", name="Reasons")).to_contain_text("The range of every UAV is too short")
    card.get_by_role("button", name="Close").click()
    expect(card).to_be_hidden()
