"""The UAVs of a mission: how many of them, and one that has changed since: its present figures are taken and given back."""

import re
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, unlimited_type
from tests.browser.pictures import Picture, in_both_themes
from tests.browser.planning.test_planning import sends
from tests.browser.planning.test_safe_routes import opens
from tests.browser.regions import region
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser


def changes(page: Page, uav: dict[str, Any], values: dict[str, Any]) -> None:
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    answer = page.request.patch(f"/api/v1/uavs/{uav['id']}", data=values, headers={"X-CSRFToken": token, "If-Match": "*"})
    assert answer.ok, answer.text()


def waits_for_changes(page: Page, mission: dict[str, Any], count: int) -> None:
    """Until the server has stored what the page says."""
    address = f"/api/v1/missions/{mission['id']}"
    page.wait_for_function(
        "async ([address, count]) => (await (await fetch(address)).json()).uav_changes.length === count", arg=[address, count]
    )


@pytest.mark.long
def test_a_battery_that_has_shrunk_is_told_taken_and_given_back(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    battery = {"battery_wh": 700.0, "mass_kg": 4.0, "max_airspeed_mps": 15.0}
    swift = sends(page, "uavs", {"name": "Swift", "type": unlimited_type(page), "position": region.east, **battery})
    towers = asks(page, f"/assets?kind=tower&bbox={region.all_towers}&limit=200")["features"]
    picked = [{"asset": tower["id"]} for tower in towers[:: len(towers) // 4][:4]]
    uavs = [{"id": swift["id"]}, {"name": "Heron", "position": region.west}]
    body = {"name": "Swift's battery", "uavs": uavs, "targets": picked, "objective": "makespan", "return_to_start": True, "plan": True}
    mission = sends(page, "missions", body)
    opens(page, mission)
    notices = page.locator("#notices")
    rows = page.locator("#uav-list")
    expect(rows).to_contain_text("700\xa0Wh")
    expect(notices).not_to_contain_text("changed since")
    changes(page, swift, {"battery_wh": 480.5})  # the page that is open hears of it
    expect(notices).to_contain_text("A UAV changed since this was planned.")
    expect(notices).to_contain_text("Swift: battery 700 → 480.5\xa0Wh.")
    in_both_themes(page, picture, "mission-uav-changed")
    assert faults(page) == []
    notices.get_by_role("button", name="Use the present figures").click()
    expect(notices).not_to_contain_text("changed since")
    expect(rows).to_contain_text("480.5\xa0Wh")
    expect(page.locator("#save-state")).to_contain_text("Saved")
    waits_for_changes(page, mission, 0)
    page.get_by_title("Undo (Ctrl+Z)").click()
    expect(notices).to_contain_text("Swift: battery 700 → 480.5\xa0Wh.")
    waits_for_changes(page, mission, 1)
    own = sends(page, "missions", body | {"name": "Swift's own battery", "uavs": [{"id": swift["id"], "battery_wh": 650.0}, uavs[1]]})
    changes(page, swift, {"battery_wh": 500.0})
    opens(page, own)
    expect(notices).to_contain_text("Swift: battery 480.5 → 500\xa0Wh in the fleet, but not in this mission.")
    in_both_themes(page, picture, "mission-uav-own-figures")
    assert faults(page) == []
    notices.get_by_role("button", name="Use the fleet's instead of this mission's own").click()
    expect(rows).to_contain_text("500\xa0Wh")
    waits_for_changes(page, own, 0)
    page.goto("/")
    row = page.get_by_role("row").filter(has_text="Swift's battery")
    expect(row).to_contain_text("UAV changed since")
    changes(page, swift, {"state": "retired"})  # it is not offered to other tests


def test_how_many_uavs_is_chosen_by_when_they_are_done(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    for name, place in ("Wren", region.west), ("Swallow", region.east):
        sends(page, "uavs", {"name": name, "type": unlimited_type(page), "position": place})
    towers = asks(page, f"/assets?kind=tower&bbox={region.all_towers}&limit=200")["features"]
    picked = [{"asset": tower["id"]} for tower in towers[:: len(towers) // 4][:4]]
    opens(page, sends(page, "missions", {"name": "How many", "targets": picked}))

    page.get_by_role("button", name="How many UAVs?").click()
    rows = page.locator("#uav-numbers tbody tr")
    expect(rows.first.get_by_role("rowheader")).to_contain_text("1")  # planned last
    expect(page.locator(".uav-numbers-progress")).to_have_count(0)
    assert rows.count() > 1
    done = rows.first.get_by_role("cell").first.inner_text()
    rows.first.get_by_role("button", name="Use 1 UAV").click()
    expect(page.locator("#plan-sentence")).to_contain_text(f"All back in {done}")
    expect(page.locator("#uav-count")).to_have_text(re.compile("^1 of "))
    expect(rows.nth(1).get_by_role("button", name="Use 2 UAVs")).to_be_visible()
    page.keyboard.press("Control+z")
    expect(page.locator("#uav-count")).to_have_text(re.compile("^0 of "))
