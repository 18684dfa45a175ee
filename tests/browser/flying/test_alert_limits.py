"""Alert thresholds: stated for a type of UAV and for a mission, in fields with units that say what is wrong with a figure."""

import re

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, stores_mission, wait_for_map
from tests.browser.pictures import Picture
from tests.browser.test_accessibility import faults
from tests.browser.test_fleet import details, fleet, writes

pytestmark = pytest.mark.browser


@pytest.fixture
def page(visitor: Visitor) -> Page:
    """Of a type that nobody has given limits yet."""
    page = visitor.signs_in("opal")
    name = "Merlin"
    known = [row["id"] for row in asks(page, "/uav-types?limit=1000")["results"] if row["name"] == name]
    key = known[0] if known else writes(page, "POST", "/uav-types", {"name": name, "cruise_speed_mps": 12})["id"]
    writes(page, "PUT", f"/uav-types/{key}/alert-limits")
    return fleet(page, f"?tab=types&id={key}")


def asked(page: Page) -> Locator:
    details(page).get_by_role("button", name="Change alert thresholds").click()
    return page.get_by_role("dialog", name="Alert thresholds: Merlin")


def saves(dialog: Locator) -> None:
    dialog.get_by_role("button", name="Save").click()


def test_limits_of_a_type_are_stated_with_their_units_and_a_wrong_figure_says_what_to_do(page: Page, picture: Picture) -> None:
    expect(details(page)).to_contain_text("Default thresholds.")
    dialog = asked(page)
    late = dialog.get_by_label("Late after")
    expect(late).to_be_focused()
    expect(late).to_have_attribute("placeholder", "5")
    late.fill("900")
    saves(dialog)
    expect(late).to_have_accessible_description("At most 600.")
    late.fill("60")
    saves(dialog)
    lost = dialog.get_by_label("Lost after")
    expect(lost).to_be_focused()
    expect(lost).to_have_accessible_description("Not below “Late after” (60). Raise this one, or lower the other.")
    picture(page, "alert-limits-light")
    assert faults(page) == []
    lost.fill("120")
    saves(dialog)
    expect(dialog).to_have_count(0)
    expect(details(page)).to_contain_text(re.compile(r"Link: Late after\s*60\ss"))
    key = re.split("[&#]", page.url.split("id=")[1])[0]
    assert asks(page, f"/uav-types/{key}/alert-limits")["stated"] == {"link_late_s": 60.0, "link_lost_s": 120.0}
    dialog = asked(page)
    dialog.get_by_role("button", name="Reset to defaults").click()
    saves(dialog)
    expect(details(page)).to_contain_text("Default thresholds.")


@pytest.mark.long
def test_a_mission_states_its_own_and_viewers_only_read(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    mission = stores_mission(page, "Close to the road")
    page.goto(mission)
    wait_for_map(page)
    page.get_by_role("button", name="More for this mission").click()
    page.get_by_role("button", name="Alert thresholds").click()
    dialog = page.get_by_role("dialog", name="Alert thresholds: Close to the road")
    dialog.get_by_role("group", name="Beside its route").get_by_label("Warning from").fill("12")
    saves(dialog)
    expect(dialog).to_have_count(0)
    assert asks(page, f"{mission}/alert-limits")["stated"] == {"off_route_m": 12.0}
    reader = visitor.signs_in("vera")
    reader.goto(mission)
    wait_for_map(reader)
    reader.get_by_role("button", name="More for this mission").click()
    expect(reader.get_by_role("button", name="History")).to_be_visible()
    expect(reader.get_by_role("button", name="Alert thresholds")).to_have_count(0)
