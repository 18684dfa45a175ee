"""Every page, wide and narrow, light and dark: pictures for the documentation. What each must keep, test_accessibility looks at."""

from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import TOO_WIDE, stores_mission, wait_for_map

pytestmark = pytest.mark.browser

Picture = Callable[[Page, str], None]
VIEWS: dict[str, dict[str, Any]] = {
    "light": {"theme": "light", "size": (1440, 900)},
    "dark": {"theme": "dark", "size": (1440, 900)},
    "phone-light": {"theme": "light", "size": (390, 844), "touch": True},
    "phone-dark": {"theme": "dark", "size": (390, 844), "touch": True},
}
PAGES = {
    "missions": "/", "map": "/missions/new", "fleet": "/uavs", "live": "/live", "assets": "/assets",
    "data-issues": "/assets/data-issues", "terrain": "/terrain", "zones": "/zones", "findings": "/findings", "account": "/account",
    "not-found": "/no-such-page",
}  # fmt: skip


def settles(page: Page) -> None:
    if page.locator("script[type=module]").count():
        page.locator("html[data-loaded]").wait_for(state="attached")
    if page.locator("#map").count():
        wait_for_map(page)


@pytest.mark.pictures
@pytest.mark.parametrize("view", VIEWS)
def test_every_page_has_its_picture(visitor: Visitor, picture: Picture, view: str) -> None:
    page = visitor.signs_in("opal", **VIEWS[view])
    stored = stores_mission(page, "River crossing, autumn")
    for name, path in PAGES.items() | {("mission", stored)}:
        page.goto("about:blank")
        page.goto(path)
        settles(page)
        picture(page, f"page-{name}-{view}")
    page = visitor.signs_in("ada", **VIEWS[view])
    page.goto("/administration")
    settles(page)
    picture(page, f"page-administration-{view}")
    visitor.complaints[:] = [words for words in visitor.complaints if "404" not in words]  # the page that is not there


def test_a_viewer_on_a_phone_sees_the_same_mission(visitor: Visitor) -> None:
    address = stores_mission(visitor.signs_in("opal"), "Shared with a viewer")
    page = visitor.signs_in("vera", **VIEWS["phone-light"])
    page.goto(address)
    settles(page)
    expect(page.locator("#target-list .target")).to_have_count(2)
    assert page.evaluate(TOO_WIDE) == []
