"""The door."""

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import PASSWORD, Visitor
from tests.browser.operator_map import stores_mission, wait_for_map

pytestmark = pytest.mark.browser


def test_wrong_password_is_refused_with_the_tries_left_and_the_right_one_opens_the_missions(
    visitor: Visitor, picture: Callable[[Page, str], None]
) -> None:
    page = visitor.opens("/missions/new")
    expect(page.get_by_role("heading", name="Sign in")).to_be_visible()
    picture(page, "sign-in-light")

    page.get_by_label("User name").fill("opal")
    page.get_by_label("Password").fill("wrong")
    page.get_by_role("button", name="Sign in").click()
    expect(page.get_by_role("alert")).to_contain_text("User name or password is wrong. 4 tries left for 15 min.")
    expect(page.get_by_label("User name")).to_have_value("opal")

    page.get_by_label("Password").fill(PASSWORD)
    page.get_by_role("button", name="Sign in").click()
    expect(page).to_have_url(re.compile(rf"^{visitor.site.address}/missions/new(#|$)"))  # where the visitor was going


@pytest.mark.long
def test_sign_in_follows_the_dark_theme_of_the_system(visitor: Visitor, picture: Callable[[Page, str], None]) -> None:
    page = visitor.opens(theme="dark")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(26, 32, 35)"
    picture(page, "sign-in-dark")


def test_a_viewer_sees_the_map_but_cannot_plan(visitor: Visitor) -> None:
    page = visitor.signs_in("vera", "/")
    expect(page.get_by_role("link", name="New mission")).to_have_count(0)
    page.goto("/missions/new")
    expect(page.get_by_text("Viewers cannot plan.")).to_be_visible()
    for name in ("Plan", "Save", "Add a UAV"):
        expect(page.get_by_role("button", name=name, exact=True)).to_have_count(0)
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    refused = page.request.post("/api/v1/plans", data={"uavs": [], "targets": []}, headers={"X-CSRFToken": token})
    assert refused.status == 403


@pytest.mark.long
@pytest.mark.parametrize("size", [(1440, 900), (390, 844)])
def test_a_viewer_has_nothing_to_edit_with(visitor: Visitor, size: tuple[int, int]) -> None:
    address = stores_mission(visitor.signs_in("opal"), "For viewers")
    page = visitor.signs_in("vera", size=size, touch=size[0] < 720)
    page.goto(address)
    wait_for_map(page)
    expect(page.locator("#target-list .target")).to_have_count(2)
    expect(page.locator("#options-words")).to_contain_text("Finish soonest")
    editing = page.locator("#side").locator(
        "input:not([readonly]), select:not(#rehearsal-list), #tools, "
        "#undo:visible, #redo:visible, #clear-targets:visible, .target .icon-button, .uav button"
    )
    expect(editing).to_have_count(0)
    page.get_by_role("button", name="More for this mission").click()
    acts = page.get_by_role("group", name="This mission").get_by_role("button").all_text_contents()
    assert acts == ["Copy link", "History", "All missions"]

    page.goto("/missions/new")
    wait_for_map(page)
    expect(page.locator("#targets-empty")).to_contain_text("No mission is open")
    expect(page.get_by_text("Nothing picked yet")).to_have_count(0)
