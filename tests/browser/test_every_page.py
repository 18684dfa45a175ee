"""Every page, wide and narrow, light and dark: nothing leaves the window; pictures for the documentation."""

import os
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import stores_mission, wait_for_map

pytestmark = pytest.mark.browser

Picture = Callable[[Page, str], None]
VIEWS: dict[str, dict[str, Any]] = {
    "light": {"theme": "light", "size": (1440, 900)},
    "dark": {"theme": "dark", "size": (1440, 900)},
    "phone-light": {"theme": "light", "size": (390, 844), "touch": True},
    "phone-dark": {"theme": "dark", "size": (390, 844), "touch": True},
}
PAGES = {
    "missions": "/", "map": "/missions/new", "fleet": "/uavs", "assets": "/assets", "gaps": "/assets/gaps", "terrain": "/terrain",
    "zones": "/zones", "account": "/account", "not-found": "/no-such-page",
}  # fmt: skip
TOO_WIDE = """() => {
    const wide = document.documentElement.scrollWidth - innerWidth;
    if (wide <= 0) return [];
    const leaves = (element) => element.getBoundingClientRect().right > innerWidth + 1;
    const guilty = [...document.body.querySelectorAll("*")].filter(leaves).slice(0, 5);
    return [`${wide} px too wide`, ...guilty.map((at) => at.outerHTML.slice(0, 120))];
}"""


def settles(page: Page) -> None:
    if page.locator("script[type=module]").count():
        page.locator("html[data-loaded]").wait_for(state="attached")
    if page.locator("#map").count():
        wait_for_map(page)


@pytest.mark.parametrize("view", VIEWS if os.environ.get("SPANWISE_SCREENSHOTS") == "1" else ["light", "phone-dark"])
def test_no_page_is_wider_than_its_window(visitor: Visitor, picture: Picture, view: str) -> None:
    page = visitor.signs_in("opal", **VIEWS[view])
    stored = stores_mission(page, "Scioto crossing, autumn")
    wide = {}
    for name, path in PAGES.items() | {("mission", stored)}:
        page.goto("about:blank")
        page.goto(path)
        settles(page)
        wide[name] = page.evaluate(TOO_WIDE)
        picture(page, f"page-{name}-{view}")
    page = visitor.signs_in("ada", **VIEWS[view])
    page.goto("/administration")
    settles(page)
    wide["administration"] = page.evaluate(TOO_WIDE)
    picture(page, f"page-administration-{view}")
    visitor.complaints[:] = [words for words in visitor.complaints if "404" not in words]  # the page that is not there
    assert {name: what for name, what in wide.items() if what} == {}


def test_a_viewer_on_a_phone_sees_the_same_mission(visitor: Visitor) -> None:
    address = stores_mission(visitor.signs_in("opal"), "Shared with a viewer")
    page = visitor.signs_in("vera", **VIEWS["phone-light"])
    page.goto(address)
    settles(page)
    expect(page.locator("#target-list .target")).to_have_count(2)
    assert page.evaluate(TOO_WIDE) == []
