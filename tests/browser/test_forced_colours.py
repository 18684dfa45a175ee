"""Forced colours, as in a high contrast theme: what is chosen, on or focused differs from what is not."""

from typing import Any

import pytest
from playwright.sync_api import Locator, Page

from tests.browser.conftest import Visitor
from tests.cases import long

pytestmark = pytest.mark.browser

LOOK = """(element, pseudo) => {
    const style = getComputedStyle(element, pseudo);
    return { background: style.backgroundColor, colour: style.color, outline: `${style.outlineStyle} ${style.outlineColor}` };
}"""
SYSTEM = """() => Object.fromEntries(["Canvas", "Highlight", "HighlightText"].map((name) => {
    const probe = document.body.appendChild(document.createElement("i"));
    probe.style.cssText = `color: ${name}; forced-color-adjust: none`;
    const { color } = getComputedStyle(probe);
    probe.remove();
    return [name, color];
}))"""


def look(found: Locator, pseudo: str | None = None) -> Any:
    return found.first.evaluate(LOOK, pseudo)


def is_filled(found: Locator, system: dict[str, str]) -> bool:
    seen = look(found)
    return bool((seen["background"], seen["colour"]) == (system["Highlight"], system["HighlightText"]))


def opened(page: Page, path: str) -> None:
    page.goto(path)
    page.locator("html[data-loaded]").wait_for(state="attached")


@pytest.mark.parametrize("theme", ["light", *long("dark")])
def test_the_chosen_is_told_from_the_others_in_forced_colours(visitor: Visitor, theme: str) -> None:
    page = visitor.signs_in("opal", theme=theme)
    page.emulate_media(forced_colors="active", color_scheme=theme)  # type: ignore[arg-type]

    opened(page, "/account")
    system = page.evaluate(SYSTEM)
    assert system["Highlight"] not in {system["Canvas"], system["HighlightText"]}
    assert is_filled(page.locator(".segments input:checked + .segment"), system)
    assert not is_filled(page.locator(".segments input:not(:checked) + .segment"), system)
    switch = page.get_by_label("Single-key shortcuts")
    on = look(switch), look(switch, "::after")
    switch.evaluate("(element) => { element.checked = !element.checked; }")
    assert look(switch)["background"] != on[0]["background"]
    assert look(switch, "::after")["background"] != on[1]["background"]
    page.locator("input[name=theme]:checked").focus()
    page.keyboard.press("Shift+Tab")
    page.keyboard.press("Tab")
    assert look(page.locator("input[name=theme]:checked + .segment"))["outline"] == f"solid {system['Highlight']}"

    opened(page, "/assets")
    assert look(page.locator(".places a[aria-current]"), "::after")["background"] == system["Highlight"]
    assert is_filled(page.locator(".page-tabs a[aria-current]"), system)
    assert not is_filled(page.locator(".page-tabs a:not([aria-current])"), system)
    measure = page.get_by_role("button", name="Measure")
    assert not is_filled(measure, system)
    measure.click()
    assert is_filled(measure, system)
