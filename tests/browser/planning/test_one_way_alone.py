"""A mission from nothing to saved: with the keyboard alone, and on a phone alone."""

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import PASSWORD, Visitor
from tests.browser.operator_map import asks, chooses_type, find_pickable, look_at, place_of, targets, unlimited_type, wait_for_map
from tests.browser.regions import region

pytestmark = pytest.mark.browser

Picture = Callable[[Page, str], None]
PHONE = {"size": (390, 844), "touch": True}
MAX_TABS = 120
FOCUSED = """() => {
    const at = document.activeElement;
    const words = at.getAttribute("aria-label") ?? (at.labels?.[0] ?? at).textContent;
    return words.replace(/\\s+/g, " ").trim();
}"""
HAS_RING = """() => {
    const at = document.activeElement;
    const shown = [at, at.nextElementSibling, at.closest("label, li, .search-box")].filter(Boolean);
    return shown.some((element) => {
        const { outlineStyle, outlineWidth } = getComputedStyle(element);
        return outlineStyle !== "none" && parseFloat(outlineWidth) >= 2;
    });
}"""


def tabs_to(page: Page, words: str) -> None:
    """Goes on with Tab until what has the focus is called so; everything on the way shows that it has it."""
    for _ in range(MAX_TABS):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement === document.body"):
            continue
        assert page.evaluate(HAS_RING), f"no focus is to be seen on {page.evaluate(FOCUSED)!r}"
        if page.evaluate(FOCUSED).startswith(words):
            return
    pytest.fail(f"Tab does not lead to {words!r}")


def types_into(page: Page, words: str, text: str) -> None:
    tabs_to(page, words)
    page.keyboard.press("Control+A")
    page.keyboard.type(text)


def test_a_mission_is_planned_and_saved_with_the_keyboard_alone(visitor: Visitor, picture: Picture) -> None:
    page = visitor.opens()
    types_into(page, "User name", "opal")
    types_into(page, "Password", PASSWORD)
    page.keyboard.press("Enter")
    expect(page.get_by_role("heading", name="Missions", exact=True)).to_be_visible()
    page.locator("html[data-loaded]").wait_for(state="attached")
    known = asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=100")["features"]

    page.keyboard.press("n")
    page.wait_for_url(re.compile("/missions/new"))
    wait_for_map(page)
    look_at(page, known[0]["geometry"]["coordinates"], 14)  # the place is part of the address, which can be typed
    for wanted in (1, 2):
        page.keyboard.press("/")
        options = page.get_by_role("listbox").get_by_role("option")
        expect(options.nth(wanted)).to_be_visible()
        for _ in range(wanted):
            page.keyboard.press("ArrowDown")
        page.keyboard.press("Enter")
        expect(page.locator("#target-list .target")).to_have_count(wanted)
        page.keyboard.press("Escape")

    unlimited = unlimited_type(page)
    tabs_to(page, "Add a UAV")
    page.keyboard.press("Enter")
    page.keyboard.press("Enter")  # in the middle of the map
    dialog = page.get_by_role("dialog")
    expect(dialog).to_be_visible()
    page.keyboard.press("Control+A")
    page.keyboard.type("Keyboard kestrel")
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    expect(dialog.get_by_label("Type")).to_be_focused()
    expect(dialog.get_by_role("option", name="Unlimited")).to_be_attached()  # the types come after the dialog
    page.keyboard.type("Unl")
    expect(dialog.get_by_label("Type")).to_have_value(f"{unlimited}")
    page.keyboard.press("Shift+Tab")
    page.keyboard.press("Shift+Tab")
    page.keyboard.press("Enter")
    expect(dialog).to_be_hidden()
    expect(page.get_by_role("checkbox", name="Keyboard kestrel")).to_be_checked()

    page.keyboard.press("p")
    expect(page.locator("#plan-sentence")).to_contain_text(re.compile("All back in|Done in"))
    picture(page, "keyboard-alone")
    types_into(page, "Name of the mission", "By keyboard")
    page.keyboard.press("Control+s")
    page.wait_for_url(re.compile(r"/missions/[0-9a-f-]{36}"))
    page.keyboard.press("Escape")
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+Shift+z")
    expect(page.locator("#target-list .target")).to_have_count(2)
    page.keyboard.press("?")
    expect(page.get_by_role("dialog", name="Keyboard")).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)


@pytest.mark.long
def test_a_mission_is_planned_and_saved_on_a_phone_alone(visitor: Visitor, picture: Picture) -> None:
    page = visitor.opens(**PHONE)
    page.get_by_label("User name").tap()
    page.keyboard.type("opal")
    page.get_by_label("Password").tap()
    page.keyboard.type(PASSWORD)
    page.get_by_role("button", name="Sign in").tap()
    expect(page.get_by_role("heading", name="Missions", exact=True)).to_be_visible()
    place = find_pickable(page)

    page.get_by_role("navigation", name="Places on a phone").get_by_role("link", name="Map").tap()
    page.wait_for_url(re.compile("/missions/new"))
    wait_for_map(page)
    at = look_at(page, place.tower["geometry"]["coordinates"])
    page.touchscreen.tap(at["x"], at["y"])
    expect(page.locator("#target-list .target")).to_have_count(1)
    longitude, latitude = place.bridge["properties"]["centre"]
    look_at(page, [longitude + 0.0005, latitude])
    at = place_of(page, [longitude, latitude])  # beside the place of the first tap: two at one place are a double tap
    page.touchscreen.tap(at["x"], at["y"])
    expect(page.locator("#target-list .target")).to_have_count(2)
    assert len(set(targets(page))) == 2

    page.get_by_role("button", name="Panel height").tap()
    page.get_by_role("button", name="Add a UAV").tap()
    unlimited_type(page)
    at = look_at(page, place.tower["geometry"]["coordinates"], 12)
    page.touchscreen.tap(at["x"], at["y"])
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("Name").fill("Pocket plover")
    chooses_type(page)
    dialog.get_by_role("button", name="Add").tap()
    expect(page.get_by_role("checkbox", name="Pocket plover")).to_be_checked()
    page.get_by_role("button", name="Plan", exact=True).tap()
    expect(page.locator("#plan-sentence")).to_contain_text(re.compile("All back in|Done in"))
    picture(page, "phone-alone-planned")
    page.wait_for_url(re.compile(r"/missions/[0-9a-f-]{36}"))
    page.get_by_role("navigation", name="Places on a phone").get_by_role("link", name="Missions").tap()
    expect(page.get_by_role("row").filter(has_text="2 targets").first).to_be_visible()
    picture(page, "phone-alone-missions")
