"""A no-fly zone for some hours, drawn on the mission's map: the plan is then outdated, and is made again round it."""

import re

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks
from tests.browser.pictures import Picture, in_both_themes
from tests.browser.planning.test_map_tools import removes_zone
from tests.browser.planning.test_planning import opens_mission
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser

NAME = "Fire at the mill"
SEEN_WITHIN_MS = 60_000


def draws_round(page: Page, x: float, y: float, half: float) -> None:
    page.mouse.move(x - half, y - half)
    page.mouse.down()
    for east, south in ((half, -half), (half, half), (-half, half), (-half, -half)):
        page.mouse.move(x + east, y + south, steps=8)
    page.mouse.up()


def begins(page: Page) -> None:
    page.get_by_role("button", name="More for this mission").click()
    page.get_by_role("button", name="Temporary no-fly zone").click()
    expect(page.get_by_text("Draw a line round the zone")).to_be_visible()


@pytest.mark.long
def test_a_zone_that_is_drawn_on_the_map_outdates_the_plan_which_then_keeps_clear_of_it(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("ada")
    opens_mission(page, "Beside a fire")
    box = page.locator("#map .map-pill").first.bounding_box()
    assert box
    begins(page)
    draws_round(page, box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, 30)
    dialog = page.get_by_role("dialog", name="Temporary no-fly zone")
    dialog.get_by_label("Name", exact=True).fill(NAME)
    dialog.get_by_label("Applies from now for").fill("3")
    in_both_themes(page, picture, "plan-temporary-zone")
    assert faults(page) == []
    dialog.get_by_role("button", name="Add the zone").click()
    expect(page.get_by_text(re.compile(rf"“{NAME}” applies until \d\d:\d\d"))).to_be_visible()
    expect(page.get_by_text("Draw a line round the zone")).to_have_count(0)
    zone = asks(page, f"/zones?text={NAME}&limit=1")["features"][0]
    try:
        again = page.locator("#notices").get_by_role("button", name="Plan again")
        expect(again).to_be_visible(timeout=SEEN_WITHIN_MS)
        again.click()
        expect(page.locator("#notices")).to_contain_text(NAME)  # the target in it is not reached
    finally:
        removes_zone(page, zone["id"])


@pytest.mark.long
def test_a_click_makes_a_circle_and_escape_leaves_all_as_it_was(visitor: Visitor) -> None:
    page = visitor.signs_in("ada")
    opens_mission(page, "No fire")
    begins(page)
    page.locator("#map canvas").focus()
    page.keyboard.press("Enter")
    dialog = page.get_by_role("dialog", name="Temporary no-fly zone")
    expect(dialog.get_by_label("Radius")).to_have_value("200")
    page.keyboard.press("Escape")
    expect(dialog).to_have_count(0)
    expect(page.get_by_text("Draw a line round the zone")).to_have_count(0)


@pytest.mark.long
def test_without_the_right_to_change_zones_it_is_not_offered(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "Not mine")
    page.get_by_role("button", name="More for this mission").click()
    expect(page.get_by_role("button", name="Temporary no-fly zone")).to_have_count(0)
