"""A tower of a mission is photographed in every part: chosen in its menu, planned in the panel, kept with the mission."""

import re
from collections.abc import Callable
from uuid import uuid4

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, wait_for_map
from tests.browser.planning.test_planning import sends
from tests.browser.regions import region
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser

CATALOGUE_CAMERA = "sony-a7r-iv-55"
PLANNED_MS = 120_000  # some seconds, more where other tests run
PLAN_PHOTOS = "Plan photos…"


def stores_mission_with_camera(page: Page) -> tuple[str, str]:
    """A mission of one tower and one UAV whose type carries a camera: its address, and the camera's name."""
    known = next(row for row in asks(page, "/camera-catalogue")["results"] if row["key"] == CATALOGUE_CAMERA)
    camera = {name: value for name, value in known.items() if name not in {"key", "maker", "payload", "sources", "derived"}}
    camera["name"] = f"Zoom {uuid4().hex[:6]}"
    kind = sends(page, "uav-types", {"name": f"Zephyr {uuid4().hex[:6]}", "range_unlimited": True, "cameras": [camera]})
    uav = sends(page, "uavs", {"name": f"Plover {uuid4().hex[:6]}", "type": kind["id"], "position": region.west})
    tower = asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=1")["features"][0]["id"]
    mission = sends(page, "missions", {"name": "Every part", "uavs": [{"id": uav["id"]}], "targets": [{"asset": tower}]})
    return f"/missions/{mission['id']}", camera["name"]


def opens_menu(page: Page) -> None:
    page.locator("#target-list .task-chip.task").click()


def test_photos_of_every_part_are_chosen_taken_over_and_kept(visitor: Visitor, picture: Callable[[Page, str], None]) -> None:
    page = visitor.signs_in("opal")
    address, camera = stores_mission_with_camera(page)
    page.goto(address)
    wait_for_map(page)
    opens_menu(page)
    page.get_by_role("button", name=PLAN_PHOTOS, exact=True).click()
    panel = page.get_by_role("region", name="Plan photos")
    panel.get_by_label("Camera", exact=True).select_option(label=camera)
    panel.get_by_label("GSD", exact=True).fill("4")
    panel.get_by_label("GSD", exact=True).press("Tab")
    use = panel.get_by_role("button", name="Use for this target")
    expect(use).to_be_visible(timeout=PLANNED_MS)
    expect(panel.get_by_role("table", name="Coverage")).to_be_visible()
    assert page.evaluate("document.scrollingElement.scrollTop") == 0, "the panel scrolls within the side"
    for theme in ("dark", "light"):
        page.emulate_media(color_scheme=theme)
        page.locator("#map[data-idle]").wait_for(state="attached")
        picture(page, f"photos-{theme}")
        assert faults(page) == []
    use.click()
    expect(panel).to_have_count(0)
    chip = page.locator("#target-list .task-chip.task")
    expect(chip).to_be_focused()
    expect(chip).to_have_attribute("title", re.compile("Photograph every part, GSD 4"))
    page.get_by_role("button", name=re.compile("^Plan P")).click()
    message = page.get_by_text("Photos need terrain data around the tower or bridge.").first
    routes = page.get_by_role("list", name="Routes").get_by_role("listitem")
    has_terrain = bool(asks(page, "/terrain")["features"])
    expect(routes.first if has_terrain else message).to_be_visible(timeout=PLANNED_MS)
    expect(page.locator("#save-state")).to_contain_text("Saved")
    page.reload()
    wait_for_map(page)
    expect(chip).to_have_attribute("title", re.compile("Photograph every part, GSD 4"))
    expect(page.locator("#save-state")).to_contain_text("Saved")
    opens_menu(page)
    page.get_by_role("button", name=PLAN_PHOTOS, exact=True).click()
    panel.get_by_label("Photos", exact=True).select_option(label="Overview from four sides")
    expect(panel.get_by_label("GSD", exact=True)).to_be_hidden()
    expect(panel.get_by_text("4 photos", exact=True)).to_be_visible(timeout=PLANNED_MS)
    use.click()
    expect(chip).to_have_attribute("title", re.compile("^Overview from four sides"))
    opens_menu(page)
    page.get_by_role("button", name="Take photos", exact=True).click()
    expect(chip).to_have_attribute("title", re.compile("^Take photos, 10"))
    opens_menu(page)
    expect(page.get_by_role("button", name=PLAN_PHOTOS, exact=True)).to_have_attribute("aria-pressed", "false")
    page.get_by_role("button", name=PLAN_PHOTOS, exact=True).click()
    panel.get_by_label("Photos", exact=True).select_option(label="Wires from both sides")
    panel.get_by_label("GSD", exact=True).fill("8")
    panel.get_by_label("GSD", exact=True).press("Tab")
    expect(panel.get_by_role("row", name=re.compile("^Wires 100"))).to_be_visible(timeout=PLANNED_MS)
    use.click()
    expect(chip).to_have_attribute("title", re.compile("^Photograph the wires from both sides, GSD 8"))
