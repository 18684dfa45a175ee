"""Nothing that was picked is lost without a word: reloads, other people's saves, ended sessions, shared browsers."""

import re

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import PASSWORD, Visitor
from tests.browser.operator_map import stores_mission, targets, wait_for_map
from tests.browser.regions import region

pytestmark = pytest.mark.browser

SAVED = re.compile(r"^Saved \d\d:\d\d$")
BEHIND = re.compile(r"Your changes are from before rory’s save at \d\d:\d\d\.")


def opens_mission(page: Page, address: str) -> Page:
    page.goto(address)
    wait_for_map(page)
    return page


def saves_as(page: Page, name: str) -> None:
    page.get_by_role("textbox", name="Name of the mission").fill(name)
    page.keyboard.press("Tab")
    page.keyboard.press("Control+s")
    expect(page.get_by_text(f"“{name}” is saved.")).to_be_visible()


def picks_from_the_search(page: Page, text: str) -> None:
    before = page.locator("#target-list .target").count()
    page.keyboard.press("/")
    page.get_by_role("combobox", name="Find an asset or a line").fill(text)
    page.get_by_role("listbox").get_by_role("option", selected=True).click()  # the best match of the text, not what is in view
    expect(page.locator("#target-list .target")).to_have_count(before + 1)
    page.locator("#map canvas").focus()


def removes_first_target(page: Page) -> None:
    page.locator("#target-list .what").first.focus()
    page.keyboard.press("Delete")


def forgives(visitor: Visitor, status: int) -> None:
    """Chromium writes every refused request to its console; this one was meant."""
    assert visitor.complaints, f"no request was answered with {status}"
    assert all(f"status of {status}" in complaint for complaint in visitor.complaints), visitor.complaints
    visitor.complaints.clear()


def cuts_the_saves(page: Page) -> None:
    page.route("**/api/v1/missions/**", lambda route: route.abort() if route.request.method == "PATCH" else route.continue_())


def is_kept_here(page: Page) -> None:
    expect(page.locator("#save-state")).to_contain_text("Not saved")
    page.wait_for_function("() => Object.keys(localStorage).some((key) => key.startsWith('spanwise.draft.'))")


@pytest.mark.long
@pytest.mark.parametrize("way", ["top", pytest.param("copy", marks=pytest.mark.long)])
def test_two_on_one_mission_keep_both_their_changes(visitor: Visitor, way: str) -> None:
    mine = visitor.signs_in("opal")
    address = stores_mission(mine, "River crossing")
    theirs = visitor.signs_in("rory")
    opens_mission(mine, address)
    opens_mission(theirs, address)
    cuts_the_saves(mine)
    removes_first_target(mine)
    mine.get_by_role("textbox", name="Name of the mission").fill("River crossing, mine")
    is_kept_here(mine)
    saves_as(theirs, "River crossing, checked")
    expect(mine.get_by_text(BEHIND)).to_be_visible()
    assert len(targets(mine)) == 1
    mine.reload()
    wait_for_map(mine)
    expect(mine.get_by_text(BEHIND)).to_be_visible()  # also a reload loses nothing
    assert len(targets(mine)) == 1
    mine.unroute("**/api/v1/missions/**")

    mine.get_by_role("button", name="See both").click()
    mine.get_by_role("button", name="Use theirs").click()
    expect(mine.get_by_role("textbox", name="Name of the mission")).to_have_value("River crossing, checked")
    expect(mine.locator("#target-list .target")).to_have_count(2)
    expect(mine.get_by_text(BEHIND)).to_be_hidden()
    visitor.complaints[:] = [words for words in visitor.complaints if "ERR_FAILED" not in words]  # of the saves that were cut
    mine.get_by_role("button", name="Back to mine").click()
    expect(mine.locator("#target-list .target")).to_have_count(1)
    expect(mine.get_by_role("textbox", name="Name of the mission")).to_have_value("River crossing, mine")

    if way == "top":
        mine.get_by_role("button", name="See both").click()
        mine.get_by_role("button", name="Put mine on top").click()
        expect(mine.get_by_text("“River crossing, mine” is saved.")).to_be_visible()
    else:
        mine.get_by_role("button", name="Keep mine as a copy").click()
        expect(mine.get_by_text("“River crossing, mine (copy)” is saved.")).to_be_visible()
        assert address not in mine.url
    expect(mine.locator("#save-state")).to_have_text(SAVED)
    stored = opens_mission(theirs, address)
    assert len(targets(stored)) == (1 if way == "top" else 2)


def test_a_save_in_one_window_leaves_the_changes_of_another(visitor: Visitor) -> None:
    first = visitor.signs_in("opal")
    address = stores_mission(first, "Two windows")
    second = first.context.new_page()
    opens_mission(first, address)
    opens_mission(second, address)
    cuts_the_saves(second)
    removes_first_target(second)
    is_kept_here(second)
    saves_as(first, "Two windows, renamed")
    expect(second.get_by_role("textbox", name="Name of the mission")).to_have_value("Two windows, renamed")  # theirs came in
    assert len(targets(second)) == 1
    second.reload()
    wait_for_map(second)
    expect(second.get_by_text("Your unsaved changes are back.")).to_be_visible()
    assert len(targets(second)) == 1
    second.unroute("**/api/v1/missions/**")
    second.reload()
    expect(second.locator("#save-state")).to_have_text(SAVED)
    expect(first.locator("#target-list .target")).to_have_count(1)


@pytest.mark.long
def test_a_cleared_selection_stays_cleared(visitor: Visitor) -> None:
    page = opens_mission(visitor.signs_in("opal"), "/missions/new")
    picks_from_the_search(page, f"{region.voltage_kv} kV")
    page.reload()
    expect(page.get_by_text("Your unsaved mission is back.")).to_be_visible()
    picks_from_the_search(page, "bridge")
    page.get_by_role("button", name="Clear", exact=True).click()
    expect(page.get_by_text("Nothing picked yet", exact=True)).to_be_visible()
    page.reload()
    wait_for_map(page)
    expect(page.get_by_text("Nothing picked yet", exact=True)).to_be_visible()
    expect(page.get_by_text("Your unsaved mission is back.")).to_have_count(0)


@pytest.mark.long
def test_saving_keeps_what_can_be_undone(visitor: Visitor) -> None:
    page = opens_mission(visitor.signs_in("opal"), "/missions/new")
    picks_from_the_search(page, f"{region.voltage_kv} kV")
    picks_from_the_search(page, "bridge")
    saves_as(page, "Undo after saving")
    with page.expect_response(lambda answer: answer.request.method == "PATCH"):
        page.get_by_role("button", name="Undo", exact=True).click()
    expect(page.locator("#target-list .target")).to_have_count(1)
    expect(page.locator("#save-state")).to_have_text(SAVED)
    page.get_by_role("button", name="Redo", exact=True).click()
    expect(page.locator("#target-list .target")).to_have_count(2)


@pytest.mark.long
def test_a_notice_about_an_empty_selection_goes_with_the_first_pick(visitor: Visitor) -> None:
    page = opens_mission(visitor.signs_in("opal"), "/missions/new")
    page.keyboard.press("p")
    expect(page.locator("#notices .critical")).to_contain_text("Nothing picked yet.")
    picks_from_the_search(page, f"{region.voltage_kv} kV")
    expect(page.locator("#notices .critical")).to_have_count(0)


def test_an_ended_session_leads_to_the_door_and_back_to_the_selection(visitor: Visitor) -> None:
    page = opens_mission(visitor.signs_in("opal"), "/missions/new")
    picks_from_the_search(page, f"{region.voltage_kv} kV")
    picked = targets(page)
    page.context.clear_cookies(name="sessionid")
    page.keyboard.press("Control+s")
    notice = page.locator("#notices").get_by_role("alert")
    expect(notice).to_contain_text("You are signed out. Your selection is kept in this browser.")
    forgives(visitor, 401)
    notice.get_by_role("link", name="Sign in").click()
    page.get_by_label("User name").fill("opal")
    page.get_by_label("Password").fill(PASSWORD)
    page.get_by_role("button", name="Sign in").click()
    expect(page.get_by_text("Your unsaved mission is back.")).to_be_visible()
    assert targets(page) == picked


@pytest.mark.long
def test_what_one_picked_is_not_shown_to_the_next_at_the_same_browser(visitor: Visitor) -> None:
    page = opens_mission(visitor.signs_in("opal"), "/missions/new")
    picks_from_the_search(page, f"{region.voltage_kv} kV")
    for name, count in (("rory", 0), ("opal", 1)):
        page.get_by_role("button", name=re.compile("^Account of")).click()
        page.get_by_role("button", name="Sign out").click()
        if name == "rory":  # opal has a draft and is asked what becomes of it
            page.get_by_role("dialog").get_by_role("button", name="Keep here").click()
        page.get_by_label("User name").fill(name)
        page.get_by_label("Password").fill(PASSWORD)
        page.get_by_role("button", name="Sign in").click()
        expect(page.get_by_role("heading", name="Missions", exact=True)).to_be_visible()
        opens_mission(page, "/missions/new")
        expect(page.locator("#target-list .target")).to_have_count(count)
