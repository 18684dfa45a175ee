"""Every page, wide in light and narrow in dark: what axe finds, and what leaves the window. Colours are measured in tokens.test.js, too."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page

from tests.browser.conftest import PROJECT_DIR, Visitor
from tests.browser.operator_map import TOO_WIDE, stores_mission
from tests.browser.page_lists import FOR_ADMINISTRATORS, FOR_CURATORS, FOR_OPERATORS, FOR_STRANGERS
from tests.cases import long

pytestmark = pytest.mark.browser

AXE = PROJECT_DIR / "node_modules" / "axe-core" / "axe.min.js"
RUN_AXE = """async () => (await axe.run(document, { resultTypes: ["violations"] })).violations
    .filter(({ impact }) => impact === "serious" || impact === "critical")
    .map(({ id, nodes }) => `${id}: ${nodes.map(({ target, any }) => target.join(" ") + " " + (any[0]?.message ?? "")).join(" | ")}`)"""
VIEWS: list[dict[str, Any]] = [
    {"theme": "light", "size": (1440, 900)},
    {"theme": "dark", "size": (390, 844), "touch": True},
]


def faults(page: Page) -> list[str]:
    page.evaluate(AXE.read_text())  # over the debugging protocol: the page's own policy would refuse it
    return [*page.evaluate(RUN_AXE), *page.evaluate(TOO_WIDE)]


def looks_at(page: Page, paths: Iterable[str]) -> dict[str, list[str]]:
    """Of each page, what is wrong with it once it has loaded."""
    found = {}
    for path in paths:
        page.goto(path)
        if page.locator("script[type=module]").count():
            page.locator("html[data-loaded]").wait_for(state="attached")
        found[path] = faults(page)
    return {path: words for path, words in found.items() if words}


@pytest.mark.parametrize("view", [VIEWS[1], *long(VIEWS[0])], ids=lambda view: f"{view['theme']}-{view['size'][0]}")
def test_axe_finds_nothing_serious_and_nothing_leaves_the_window_on_any_page(visitor: Visitor, view: dict[str, Any]) -> None:
    assert AXE.exists(), f"{Path(AXE).name} is missing; scripts/setup installs it"
    found = looks_at(visitor.opens(**view), FOR_STRANGERS)
    page = visitor.signs_in("opal", **view)
    stored = stores_mission(page, f"Looked at in {view['theme']} at {view['size'][0]}")
    found |= looks_at(page, [*FOR_OPERATORS, stored, f"{stored}/report"])
    found |= looks_at(visitor.signs_in("cora", **view), FOR_CURATORS)
    found |= looks_at(visitor.signs_in("ada", **view), FOR_ADMINISTRATORS)
    visitor.complaints[:] = [words for words in visitor.complaints if "404" not in words]  # the page that is not there
    assert found == {}
