"""What UAVs do when their link is lost: chosen, rally points put on the map and moved, checked in words, undone, read by viewers."""

import re
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import TOO_WIDE, look_at, place_of, wait_for_map
from tests.browser.pictures import Picture, in_both_themes
from tests.browser.planning.test_flight_options import is_saved, mission_of
from tests.browser.planning.test_planning import opens_mission
from tests.browser.planning.test_planning_options import PHONE
from tests.browser.regions import RESERVE, region
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser

IN_RESERVE = "{1}, {0}".format(*region.in_reserve)
UNCOUNTED = "Energy is not checked for Heron, Kite: no battery is stated."


def panel(page: Page) -> Locator:
    return page.locator("#lost-link")


def rally_points(page: Page) -> Locator:
    return panel(page).get_by_role("list", name="Rally points").get_by_role("listitem")


def stored_wish(page: Page) -> dict[str, Any]:
    wish: dict[str, Any] = mission_of(page)["lost_link"]
    return wish


def says_what_is_stored(page: Page) -> set[tuple[int, str | None]]:
    """Once it is checked, the page tells the server's check. Where ways back lead that fail, and the zones that bar them."""
    expect(panel(page).locator(".link-check")).to_have_attribute("data-state", re.compile("^(home|lost)$"))
    plan = mission_of(page)["plan"]
    failed = plan["lost_link"]["failed"]
    count, total = len({(one["route"], one["waypoint"]) for one in failed}), sum(len(route["waypoints"]) for route in plan["routes"])
    lost = f"From {count} of {total} waypoints a UAV would not get home."
    expect(panel(page).locator(".link-said")).to_have_text(lost if failed else "From every waypoint the way back meets no zone.")
    return {(one["return_point"], one["zone"]) for one in failed}


def test_the_way_back_is_chosen_rally_points_are_placed_dragged_and_undone_and_the_check_tells_the_zone(
    visitor: Visitor, picture: Picture
) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "Link lost", targets=6, box=region.spread_towers)
    is_saved(page)
    routes = mission_of(page)["plan"]["routes"]
    panel(page).get_by_role("radio", name="Return", exact=True).check()
    expect(panel(page)).to_contain_text("None yet: each UAV returns to its own start.")
    expect(panel(page)).to_contain_text(UNCOUNTED)
    assert {return_point for return_point, _ in says_what_is_stored(page)} <= {0}

    panel(page).get_by_role("button", name="Add on the map").click()
    place = look_at(page, region.clear, 13)
    page.mouse.click(**place)
    expect(rally_points(page)).to_have_count(1)
    page.get_by_role("button", name="Done").click()
    mark = page.get_by_role("img", name="Rally point R1")
    box = mark.bounding_box()
    assert box
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 80, box["y"] + 20, steps=5)
    page.mouse.up()
    says_what_is_stored(page)
    dragged = stored_wish(page)
    assert dragged["behaviour"] == "return"
    assert place_of(page, dragged["rally_points"][0])["x"] == pytest.approx(place["x"] + 80 - box["width"] / 2, abs=3)
    assert mission_of(page)["plan"]["routes"] == routes  # nothing was planned anew

    typed = panel(page).get_by_label("Add by coordinates")
    typed.fill("somewhere")
    typed.press("Enter")
    expect(panel(page)).to_contain_text("Latitude and longitude are wanted")
    expect(typed).to_be_focused()
    typed.fill(IN_RESERVE)
    typed.press("Enter")
    expect(rally_points(page)).to_have_count(2)
    failures = panel(page).get_by_role("list", name="From where a UAV would not get home")
    expect(failures.get_by_role("button", name=re.compile(f"back to R2 ?the way back meets {RESERVE}"))).to_be_visible()
    assert (2, RESERVE) in says_what_is_stored(page)
    expect(page.locator("#plan-quality")).to_contain_text(re.compile(r"On link loss: From \d+ of \d+ waypoints a UAV would not get home"))
    failures.get_by_role("button").first.click()
    expect(page.locator("#legend")).to_contain_text("Way back without a link that fails")
    in_both_themes(page, picture, "plan-lost-link")
    assert faults(page) == []

    panel(page).get_by_role("button", name="Remove R2").click()
    expect(rally_points(page)).to_have_count(1)
    expect(panel(page).get_by_role("button", name="Remove R1")).to_be_focused()
    page.keyboard.press("Control+z")
    expect(rally_points(page)).to_have_count(2)
    page.keyboard.press("Control+Shift+z")
    assert {return_point for return_point, _ in says_what_is_stored(page)} <= {0, 1}
    panel(page).get_by_role("radio", name="Hold, then return").check()
    panel(page).get_by_label("Holds for").fill("90")
    panel(page).get_by_label("Holds for").press("Tab")
    assert {return_point for return_point, _ in says_what_is_stored(page)} <= {0, 1}
    page.reload()
    wait_for_map(page)
    expect(panel(page).get_by_label("Holds for")).to_have_value("90")
    assert stored_wish(page) == {"behaviour": "hold", "rally_points": dragged["rally_points"], "hold_s": 90.0}


@pytest.mark.long
def test_on_a_phone_a_rally_point_is_placed_by_keys_and_flights_end_as_set_beside_it(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal", **PHONE)
    opens_mission(page, "Link lost on a phone", targets=3)
    page.get_by_role("button", name="Panel height").click()
    page.get_by_role("switch", name="Return to start").uncheck()
    page.get_by_label("How the flight of Kite ends").select_option("land")
    panel(page).get_by_role("radio", name="Return", exact=True).check()
    expect(panel(page)).to_contain_text("It is checked for energy and zones once there is a plan.")
    panel(page).get_by_role("button", name="Add on the map").press("Enter")
    page.locator("body").press("Enter")
    expect(rally_points(page)).to_have_count(1)
    page.get_by_role("button", name="Done").click()
    page.get_by_role("button", name="Panel height").click()
    panel(page).get_by_role("button", name="Remove R1").scroll_into_view_if_needed()
    picture(page, "plan-lost-link-phone-dark")
    assert faults(page) == []
    assert page.evaluate(TOO_WIDE) == []
    is_saved(page)
    stored = mission_of(page)
    assert (stored["return_to_start"], stored["uavs"][1]["end_action"]) == (False, "land")
    assert len(stored["lost_link"]["rally_points"]) == 1


@pytest.mark.long
def test_a_viewer_reads_what_is_done_without_a_link_and_cannot_change_it(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "Link lost to be read", targets=3)
    panel(page).get_by_role("radio", name="Return", exact=True).check()
    panel(page).get_by_label("Add by coordinates").fill(IN_RESERVE)
    panel(page).get_by_role("button", name="Add", exact=True).click()
    expect(panel(page).locator(".link-check")).to_have_attribute("data-state", re.compile("^(home|lost)$"))
    is_saved(page)
    address = page.url
    stated = panel(page).locator(".link-said").inner_text()
    page = visitor.signs_in("vera")
    page.goto(address)
    wait_for_map(page)
    expect(page.locator("#options-words")).to_contain_text("without a link each UAV returns, 1 rally point")
    expect(panel(page).locator(".link-said")).to_have_text(stated)
    expect(page.get_by_role("img", name="Rally point R1")).to_be_visible()
    expect(panel(page).get_by_role("textbox")).to_have_count(0)
    expect(panel(page).get_by_role("radio")).to_have_count(0)
