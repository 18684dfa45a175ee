"""The list of missions: found, sorted, renamed, copied, deleted and brought back, without leaving it."""

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, Page, Route, expect

from missions.models import MissionState
from tests.browser.conftest import Visitor
from tests.browser.operator_map import TOO_WIDE, stores_mission

pytestmark = pytest.mark.browser


def opens_list(page: Page, address: str = "/") -> Page:
    page.goto(address)
    page.locator("html[data-loaded]").wait_for(state="attached")
    return page


def row(page: Page, name: str) -> Locator:
    return page.get_by_role("row").filter(has=page.get_by_role("link", name=name, exact=True))


def seeks(page: Page, text: str) -> None:
    page.keyboard.press("/")
    field = page.get_by_role("searchbox", name="Find a mission by name, target or author")
    expect(field).to_be_focused()
    field.fill(text)


def names(page: Page) -> list[str]:
    return page.locator("#rows .name a").all_text_contents()


def test_missions_are_found_by_name_and_target_and_sorted_by_a_column(visitor: Visitor, picture: Callable[[Page, str], None]) -> None:
    page = visitor.signs_in("opal")
    for name in ("Zebra ford", "Aspen ford", "Maple ford"):
        stores_mission(page, name)
    opens_list(page)
    seeks(page, " ford")
    expect(page.locator("#how-many")).to_have_text("1 to 3 of 3")
    page.get_by_role("button", name="Mission", exact=True).click()
    expect(page.locator("#rows .name a").first).to_have_text("Aspen ford")
    assert names(page) == ["Aspen ford", "Maple ford", "Zebra ford"]
    expect(page.get_by_role("columnheader", name="Mission")).to_have_attribute("aria-sort", "ascending")
    page.get_by_role("button", name="Mission", exact=True).click()
    expect(page.locator("#rows .name a").first).to_have_text("Zebra ford")
    target = page.request.get(f"/api/v1{row_address(page, 'Aspen ford')}").json()["targets"][0]["label"]
    seeks(page, target)
    expect(page).to_have_url(re.compile(re.escape(f"text={target.split()[0]}")))
    expect(row(page, "Aspen ford")).to_be_visible()
    opens_list(page, page.url)  # the address holds what was asked
    expect(page.get_by_role("searchbox")).to_have_value(target)
    seeks(page, "nothing is called this")
    expect(page.get_by_text("No mission matches “nothing is called this”")).to_be_visible()
    picture(page, "missions-none")
    page.get_by_role("button", name="Clear the filters").last.click()
    expect(row(page, "Aspen ford")).to_be_visible()


def row_address(page: Page, name: str) -> str:
    return row(page, name).get_by_role("link", name=name).get_attribute("href") or ""


@pytest.mark.long
def test_filters_by_author_state_and_changed_ground_leave_what_they_say(visitor: Visitor) -> None:
    stores_mission(visitor.signs_in("rory"), "Made by Rory")
    page = visitor.signs_in("opal")
    stores_mission(page, "Made by Opal")
    opens_list(page)
    page.get_by_text("More filters").click()
    page.get_by_role("combobox", name="Author", exact=True).select_option("rory")
    expect(row(page, "Made by Opal")).to_have_count(0)
    expect(row(page, "Made by Rory")).to_be_visible()
    page.get_by_role("checkbox", name="Ground or a UAV changed since planning").check()
    expect(page.get_by_text("No mission is like that")).to_be_visible()
    page.locator("#clear-filters").click()
    page.get_by_role("radio", name="Planned").check()
    expect(row(page, "Made by Opal").get_by_text("Planned")).to_be_visible()
    page.get_by_role("combobox", name="Changed", exact=True).select_option("between")
    page.get_by_label("To", exact=True).fill("2020-01-01")
    page.get_by_label("To", exact=True).press("Tab")
    expect(page.get_by_text("No mission is like that")).to_be_visible()


@pytest.mark.long
def test_a_mission_is_renamed_in_its_place_and_the_name_taken_back(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    stores_mission(page, "Wrong name")
    opens_list(page)
    row(page, "Wrong name").get_by_role("button", name="Rename: Wrong name").focus()
    page.keyboard.press("Enter")
    field = page.get_by_role("textbox", name="New name of Wrong name")
    expect(field).to_be_focused()
    field.fill("Right name")
    field.press("Enter")
    expect(page.get_by_text("“Wrong name” is now “Right name”.")).to_be_visible()
    expect(row(page, "Right name")).to_be_visible()
    page.get_by_role("button", name="Undo", exact=True).click()
    expect(row(page, "Wrong name")).to_be_visible()
    row(page, "Wrong name").get_by_role("button", name="More for Wrong name").click()
    page.get_by_role("button", name="Rename", exact=True).click()
    page.get_by_role("textbox", name="New name of Wrong name").press("Escape")
    expect(row(page, "Wrong name")).to_be_visible()


@pytest.mark.long
def test_a_mission_is_duplicated_with_its_plan(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    stores_mission(page, "Twice")
    opens_list(page)
    row(page, "Twice").get_by_role("button", name="More for Twice").click()
    page.get_by_role("button", name="Duplicate", exact=True).click()
    expect(page.get_by_text("“Twice (copy)” is there.")).to_be_visible()
    expect(row(page, "Twice (copy)").get_by_text("Planned")).to_be_visible()
    assert row(page, "Twice (copy)").locator(".distance").text_content() == row(page, "Twice").locator(".distance").text_content()


@pytest.mark.long
def test_several_missions_are_deleted_at_once_and_brought_back(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    for number in range(3):
        stores_mission(page, f"Batch {number}")
    opens_list(page)
    seeks(page, "Batch")
    expect(page.locator("#how-many")).to_have_text("1 to 3 of 3")
    page.get_by_role("checkbox", name="Choose Batch 1").check()
    expect(page.get_by_text("1 mission chosen")).to_be_visible()
    page.get_by_role("checkbox", name="Choose all on this page").check()
    expect(page.get_by_text("3 missions chosen")).to_be_visible()
    page.get_by_role("group", name="Chosen missions").get_by_role("button", name="Delete").click()
    expect(page.get_by_text("3 missions are deleted.")).to_be_visible()
    expect(page.get_by_text("No mission matches “Batch”")).to_be_visible()
    page.get_by_role("radio", name="Deleted").check()
    deleted = page.get_by_role("row").filter(has_text="Batch 0")
    deleted.get_by_role("button", name="Bring back").click()
    expect(page.get_by_text("“Batch 0” is back.")).to_be_visible()
    expect(deleted).to_have_count(0)
    page.get_by_role("radio", name="All").check()
    expect(row(page, "Batch 0")).to_be_visible()
    expect(row(page, "Batch 1")).to_have_count(0)


@pytest.mark.long
def test_the_list_pages_forth_and_back(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    address = stores_mission(page, "Many of it")
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    for number in range(26):
        page.request.post(f"/api/v1{address}/duplicate", data={"name": f"Page {number:02}"}, headers={"X-CSRFToken": token})
    opens_list(page, "/?text=Page&order=name")
    expect(page.locator("#how-many")).to_have_text("1 to 25 of 26")
    page.get_by_role("button", name="Next").click()
    expect(page.locator("#how-many")).to_have_text("26 to 26 of 26")
    assert names(page) == ["Page 25"]
    page.get_by_role("button", name="Back").click()
    expect(page.locator("#how-many")).to_have_text("1 to 25 of 26")
    expect(page.locator("#rows .name a").first).to_have_text("Page 00")


@pytest.mark.long
def test_a_phone_scrolls_through_the_states_and_the_page_stays_as_wide_as_the_window(visitor: Visitor) -> None:
    page = visitor.signs_in("opal", size=(390, 844), touch=True)

    def with_every_state(route: Route) -> None:
        answer = route.fetch()
        route.fulfill(response=answer, json=answer.json() | {"by_state": dict.fromkeys(MissionState.values, 12), "deleted_count": 12})

    page.route("**/api/v1/missions?*", with_every_state)
    opens_list(page)
    expect(page.locator("#states label")).to_have_count(len(MissionState.values) + 2)
    assert page.evaluate(TOO_WIDE) == []


def test_viewers_open_missions_and_change_none(visitor: Visitor) -> None:
    stores_mission(visitor.signs_in("opal"), "Only to look at")
    page = visitor.signs_in("vera", "/")
    expect(row(page, "Only to look at")).to_be_visible()
    expect(page.get_by_role("checkbox", name=re.compile("Choose"))).to_have_count(0)
    row(page, "Only to look at").get_by_role("button", name="More for Only to look at").click()
    expect(page.get_by_role("button", name="Open", exact=True)).to_be_visible()
    expect(page.get_by_role("button", name="Delete")).to_have_count(0)


@pytest.mark.long
def test_the_tour_is_walked_by_keyboard_ended_by_escape_and_remembered(visitor: Visitor) -> None:
    page = opens_list(visitor.signs_in("opal"), "/?tour")
    for title in ("Missions", "Plan", "Live", "Assets and zones"):
        expect(page.get_by_role("dialog", name=title, exact=True)).to_be_visible()
        expect(page.locator(".tour-target")).to_have_count(1)
        page.keyboard.press("ArrowRight")
    expect(page.get_by_role("dialog", name="UAVs", exact=True)).to_contain_text("5 of 5")
    page.keyboard.press("ArrowLeft")
    expect(page.get_by_role("dialog", name="Assets and zones", exact=True)).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.locator(".tour, .tour-target")).to_have_count(0)
    assert page.evaluate("Object.keys(localStorage).some((key) => key.startsWith('tour-seen-'))")
