"""A camera of the catalogue is given to a UAV type, and photos of a tower are planned with it."""

import math
import re
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, Response, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, place_of, wait_for_map
from tests.browser.regions import region
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser

Picture = Callable[[Page, str], None]
PLANNED_MS = 120_000  # some seconds, more where other tests run
CAMERA = "Mavic 3 Enterprise, tele camera"
CONE_PX = 24
TOO_COARSE = "Matrice 30T, thermal camera"


def adds_camera(page: Page, text: str, name: str) -> None:
    page.get_by_role("button", name="Add a camera").click()
    page.get_by_label("Find a camera").fill(text)
    page.get_by_label("Catalogue").select_option(label=name)
    expect(page.locator(".camera-chosen")).to_contain_text("not verified")
    assert faults(page) == []
    page.get_by_role("button", name="Add this camera").click()


def a_type_gets_a_camera(page: Page) -> None:
    page.goto("/uavs")
    page.locator("html[data-loaded]").wait_for(state="attached")
    page.get_by_role("radio", name="Types").check()
    page.get_by_role("button", name="New type", exact=True).first.click()
    page.get_by_label("Name", exact=True).fill("Photographer")
    page.get_by_label("Speed", exact=True).fill("10")
    adds_camera(page, "30t thermal", TOO_COARSE)
    adds_camera(page, "mavic tele", CAMERA)
    camera = page.locator("fieldset.camera").last
    camera.get_by_text("Figures", exact=True).click()
    camera.get_by_label("Pixels down").fill("100")
    page.get_by_role("button", name="Save", exact=True).click()
    expect(camera.get_by_label("Pixels down")).to_have_accessible_description(re.compile("square", re.IGNORECASE))
    camera.get_by_label("Pixels down").fill("3000")
    page.get_by_role("button", name="Save", exact=True).click()
    cameras = page.get_by_role("region", name="Details").locator(".type-cameras")
    expect(cameras).to_contain_text(CAMERA)
    expect(cameras).to_contain_text("2\u00a0mm at 37.5\u00a0m")


def clicks_a_cone(page: Page, panel: Locator, photos: list[dict[str, Any]]) -> None:
    """Photos may stand above one another: the row is of one that is there."""
    place = place_of(page, photos[0]["position"])
    page.mouse.click(place["x"], place["y"])
    pressed = panel.locator(".photo-row[aria-pressed='true']")
    expect(pressed).to_have_count(1)
    expect(pressed).to_be_in_viewport()
    number = int(re.findall(r"\d+", pressed.inner_text())[0])
    chosen = place_of(page, photos[number - 1]["position"])
    assert math.dist(place.values(), chosen.values()) < CONE_PX


@pytest.mark.long
def test_photos_of_a_tower_are_planned_with_the_camera_of_a_type(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    a_type_gets_a_camera(page)
    visitor.complaints[:] = [words for words in visitor.complaints if "400" not in words]  # of the figure that was refused
    tower = asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=1")["features"][0]["id"]
    plans: list[Response] = []
    page.on("response", lambda response: plans.append(response) if response.url.endswith("/view-plans") else None)
    page.goto(f"/assets?id={tower}")
    wait_for_map(page)
    page.get_by_role("button", name="Plan photos").click()
    panel = page.get_by_role("region", name="Plan photos")
    expect(panel.get_by_label("Camera", exact=True).locator("option:checked")).to_have_text(CAMERA, timeout=PLANNED_MS)
    coverage = panel.get_by_role("table", name="Coverage")
    expect(coverage).to_be_visible(timeout=PLANNED_MS)
    expect(coverage.get_by_role("row", name=re.compile("Insulator strings|Head|Body")).first).to_contain_text("%")
    expect(panel.get_by_text(re.compile("^Model: "))).to_be_visible()
    panel.locator("summary", has_text="photos").click()
    photo = panel.get_by_role("button", name=re.compile("^Photo 2"))
    photo.click()
    expect(photo).to_have_attribute("aria-pressed", "true")
    for theme in ("dark", "light"):
        page.emulate_media(color_scheme=theme)
        page.locator("#map[data-idle]").wait_for(state="attached")
        picture(page, f"view-plan-{theme}")
        assert faults(page) == []
    photo.click()
    expect(photo).to_have_attribute("aria-pressed", "false")
    clicks_a_cone(page, panel, plans[-1].json()["photos"])
    panel.get_by_label("Camera", exact=True).select_option(label=TOO_COARSE)
    expect(panel.get_by_text("Nothing can be shown.")).to_be_visible(timeout=PLANNED_MS)
    expect(panel.get_by_text(re.compile(r"This camera shows .* at the clearance of .* at best"))).to_be_visible()
    panel.get_by_role("button", name="Close").click()
    expect(panel).to_have_count(0)
    expect(page.get_by_role("button", name="Plan photos")).to_be_focused()
