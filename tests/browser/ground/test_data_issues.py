"""The workbench: from the list to the place, a repair that is taken back, and who may only look."""

import re
from collections.abc import Callable
from datetime import UTC, datetime

import pytest
from playwright.sync_api import Page, Route, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, at_zoom, place_of, wait_for_map
from tests.browser.regions import region

pytestmark = pytest.mark.browser


def opens_issues(
    visitor: Visitor, name: str, *, kind: str = "", size: tuple[int, int] = (1440, 900), theme: str = "light", keeps_searching: bool = False
) -> Page:
    page = visitor.signs_in(name, size=size, theme=theme, touch=size[0] < 721)
    if keeps_searching:
        page.route("**/data-issues/summary", just_searched)
    page.goto("/assets/data-issues")
    wait_for_map(page)
    expect(page.locator("#page-facts")).to_contain_text("open · search", timeout=90_000)  # the first search waits for workers that start
    if kind:
        page.locator(".kind-chip", has_text=kind).click()
        expect(page.locator("#issue-list")).to_have_attribute("aria-busy", "false")  # or the first row were still one of all kinds
    return page


def just_searched(route: Route) -> None:
    """As while others change the ground: at each look, every 2 s, it has been searched anew, and has changed again."""
    answer = route.fetch()
    summary = answer.json()
    if summary["searched_at"]:
        summary |= {"searched_at": datetime.now(UTC).isoformat(), "is_current": False}
    route.fulfill(response=answer, json=summary)


def rows(page: Page) -> list[str]:
    return page.locator(".issue-row strong").all_text_contents()


def open_number(page: Page) -> int:
    return int(re.sub(r"\D", "", page.locator("#issue-states .count").first.inner_text()))


def test_an_issue_is_found_shown_mended_and_the_repair_taken_back(visitor: Visitor) -> None:
    page = opens_issues(visitor, "cora", kind="Towers missing")
    lines, untagged, vertices = region.missing_towers
    expect(page.locator(".issue-row")).to_have_count(lines)
    before = open_number(page)
    page.locator(".issue-row").first.click()
    expect(page.get_by_role("heading", name=f"{untagged} of {vertices} vertices have no tower")).to_be_visible()
    wait_for_map(page)
    issue_id = int(re.search(r"issue=(\d+)", page.url)[1])  # type: ignore[index]
    frame = page.locator("#map").bounding_box()
    assert frame
    for position in asks(page, f"/data-issues/{issue_id}")["geometry"]["coordinates"]:
        place = place_of(page, position)
        assert frame["x"] < place["x"] < frame["x"] + frame["width"]
        assert frame["y"] < place["y"] < frame["y"] + frame["height"]

    page.get_by_role("button", name=f"Make {untagged} towers of the vertices").click()
    expect(page.locator(".toast")).to_contain_text(f"{untagged} towers placed.")
    expect(page.locator(".issue-decided")).to_contain_text("Repaired by cora")
    assert open_number(page) < before
    assert asks(page, f"/data-issues/{issue_id}")["properties"]["state"] == "repaired"
    page.get_by_role("button", name="Undo").click()
    expect(page.locator(".toast")).to_contain_text("Taken back.")
    expect(page.get_by_role("button", name=f"Make {untagged} towers of the vertices")).to_be_visible()
    assert open_number(page) == before


@pytest.mark.long
def test_keys_go_along_the_list_and_to_the_place(visitor: Visitor) -> None:
    page = opens_issues(visitor, "cora")
    names = rows(page)
    page.keyboard.press("j")
    page.keyboard.press("j")
    page.keyboard.press("k")
    page.keyboard.press("j")
    page.keyboard.press("Enter")
    expect(page.locator(".issue-row[aria-current=true] strong")).to_have_text(names[1])
    expect(page.locator(".issue-sentence")).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.locator("#dock")).to_be_hidden()


@pytest.mark.long
def test_an_issue_that_is_right_is_left_with_a_note_and_opened_again(visitor: Visitor) -> None:
    page = opens_issues(visitor, "cora", kind="Bridges without a way", keeps_searching=True)
    page.locator(".issue-row").first.click()
    page.get_by_role("button", name="Leave it as it is").click()
    page.get_by_role("textbox", name="Note").fill("A pipe bridge, seen on site.")
    for _ in range(2):  # of the second look the first answer has been taken in
        page.wait_for_event("response", lambda response: re.search(r"/data-issues/\d+$", response.url) is not None)
    expect(page.get_by_role("textbox", name="Note")).to_be_focused()
    page.get_by_role("button", name="Leave it", exact=True).click()
    expect(page.locator(".issue-decided")).to_contain_text("A pipe bridge, seen on site.")
    page.get_by_role("radio", name="Ignored").check()
    expect(page.locator(".issue-row")).to_have_count(1)
    page.get_by_role("button", name="Open it again").click()
    expect(page.locator("#issue-list-end")).to_contain_text("No issue like that here.")


@pytest.mark.long
def test_filters_narrow_the_list_and_an_empty_one_says_so(visitor: Visitor) -> None:
    page = opens_issues(visitor, "cora")
    whole = len(rows(page))
    page.get_by_role("searchbox").fill("no such line")
    expect(page.locator("#issue-list-end")).to_contain_text("No issue matches “no such line”.")
    page.get_by_role("button", name="Clear the filter").click()
    expect(page.locator(".issue-row")).to_have_count(whole)
    page.evaluate("(hash) => { location.hash = hash; }", at_zoom(16, region.at(0.1, -0.05)))
    page.get_by_role("checkbox", name="In view").check()
    expect(page.locator(".issue-row")).not_to_have_count(whole)


@pytest.mark.long
def test_who_is_no_curator_sees_gaps_and_cannot_mend_them(visitor: Visitor) -> None:
    page = opens_issues(visitor, "opal")
    page.locator(".issue-row").first.click()
    expect(page.locator(".issue-do")).to_have_text("Curators can repair this.")
    expect(page.locator(".issue-acts button")).to_have_count(0)


@pytest.mark.long
@pytest.mark.parametrize("theme", ["light", pytest.param("dark", marks=pytest.mark.long)])
@pytest.mark.parametrize(("width", "height", "suffix"), [(1440, 900, ""), (390, 844, "-phone")])
def test_the_chosen_issue_stands_in_sight(
    visitor: Visitor, picture: Callable[[Page, str], None], theme: str, width: int, height: int, suffix: str
) -> None:
    page = opens_issues(visitor, "cora", size=(width, height), theme=theme)
    page.locator(".issue-row").first.click()
    expect(page.locator(".issue-sentence")).to_be_in_viewport()
    wait_for_map(page)
    expect(page.locator(".issue-acts .primary")).to_be_in_viewport()
    picture(page, f"data-issues{suffix}-{theme}")
