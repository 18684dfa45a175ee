"""A curator corrects an asset, draws a zone, and takes changes back; of two at once nobody overwrites the other unseen."""

from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor

pytestmark = pytest.mark.browser
PHONE = (390, 844)
Picture = Callable[[Page, str], None]


def opens(visitor: Visitor, path: str, name: str = "cora", **how: object) -> Page:
    page = visitor.signs_in(name, **how)
    page.goto(path)
    page.locator("html[data-loaded]").wait_for(state="attached")
    return page


def finds(page: Page, text: str, row: str) -> None:
    with page.expect_response(lambda answer: "text=" in answer.url):
        page.get_by_label("Find", exact=True).fill(text)
    expect(page.locator(".record-row").first).to_contain_text(row)
    page.locator(".record-row").first.click()
    expect(page.locator("#record-show .record-title")).to_be_visible()


def clicks_on_the_map(page: Page, *places: tuple[float, float]) -> None:
    """At shares of the map's width and height."""
    box = page.locator("#map").bounding_box()
    assert box
    for across, down in places:
        x, y = box["x"] + across * box["width"], box["y"] + down * box["height"]
        page.mouse.move(x, y)
        page.mouse.click(x, y)


def test_a_fact_is_corrected_told_in_the_history_and_brought_back(visitor: Visitor, picture: Picture) -> None:
    page = opens(visitor, "/assets")
    finds(page, "138 kV", "138 kV")
    page.get_by_role("button", name="Edit", exact=True).click()
    page.get_by_label("Name", exact=True).fill("Northern feeder")
    page.get_by_label("Operator").fill("Test operator")
    expect(page.locator(".draw-figures")).to_contain_text("points")
    picture(page, "assets-edit-light")
    page.get_by_role("button", name="Save").click()
    expect(page.locator(".history-list li").first).to_contain_text("Northern feeder")
    picture(page, "assets-light")
    page.get_by_role("button", name="Bring back what was before").first.click()
    expect(page.locator(".history-list li").first).to_contain_text("Brought back to an earlier state")
    page.keyboard.press("Escape")
    expect(page.get_by_label("Find", exact=True)).to_be_visible()


def test_the_second_of_two_curators_is_asked_and_overwrites_nothing_unseen(visitor: Visitor) -> None:
    page = opens(visitor, "/assets")
    finds(page, "138 kV", "138 kV")
    page.get_by_role("button", name="Edit", exact=True).click()
    asset = page.url.split("id=")[1]
    other = """async (id) => {
        const token = document.cookie.split("; ").find((part) => part.startsWith("csrftoken=")).split("=")[1];
        const answer = await fetch(`/api/v1/assets/${id}`, {
            method: "PATCH", headers: { "If-Match": "*", "Content-Type": "application/json", "X-CSRFToken": token },
            body: JSON.stringify({ operator: "Theirs" }) });
        return answer.status;
    }"""
    assert page.evaluate(other, asset) == 200
    page.get_by_label("Operator").fill("Mine")
    page.get_by_role("button", name="Save").click()
    dialog = page.get_by_role("dialog")
    expect(dialog).to_contain_text("Theirs → Mine")
    dialog.get_by_role("button", name="Take theirs").click()
    expect(page.locator("#record-show")).to_contain_text("Theirs")
    visitor.complaints.clear()  # the browser tells of the answer 412, which is meant


def test_a_zone_is_drawn_with_a_hole_heights_and_hours_and_undone(visitor: Visitor, picture: Picture) -> None:
    page = opens(visitor, "/zones")
    expect(page.locator(".record-row").first).to_be_visible()
    page.get_by_role("button", name="New zone").click()
    page.get_by_role("button", name="Area", exact=True).click()
    clicks_on_the_map(page, (0.3, 0.25), (0.6, 0.25), (0.6, 0.6), (0.3, 0.6))
    page.keyboard.press("Enter")
    page.get_by_role("button", name="Hole").click()
    clicks_on_the_map(page, (0.4, 0.35), (0.5, 0.35), (0.45, 0.5))
    page.keyboard.press("Enter")
    expect(page.locator(".draw-figures")).to_contain_text("7 points")
    for _ in range(3):
        page.keyboard.press("Control+z")
    expect(page.locator(".draw-figures")).to_contain_text("4 points")
    for _ in range(3):
        page.keyboard.press("Control+Shift+z")
    expect(page.locator(".draw-figures")).to_contain_text("7 points")
    page.get_by_label("Name", exact=True).fill("Works at the yard")
    page.get_by_label("Upper limit, counted from").select_option("AGL")
    page.get_by_label("Upper limit, value").fill("120")
    picture(page, "zones-draw-light")
    page.get_by_role("switch", name="Always").click()
    page.get_by_label("Ends", exact=True).select_option("SS")
    page.locator("#side-scroll").evaluate("(panel) => (panel.scrollTop = panel.scrollHeight)")
    picture(page, "zone-schedule-light")
    page.get_by_role("button", name="Save").click()
    shown = page.locator("#record-show")
    expect(shown).to_contain_text("Mon to Fri 08:00 to sunset UTC")
    expect(shown).to_contain_text("120 m above ground")
    picture(page, "zones-light")
    page.get_by_role("button", name="Delete").click()
    page.get_by_role("button", name="Undo", exact=True).click()
    expect(shown).to_contain_text("Works at the yard")
    page.get_by_role("button", name="Delete").click()
    expect(page.get_by_label("Find", exact=True)).to_be_visible()


def test_a_border_that_crosses_itself_cannot_be_saved(visitor: Visitor) -> None:
    page = opens(visitor, "/zones")
    page.get_by_role("button", name="New zone").click()
    page.get_by_role("button", name="Area", exact=True).click()
    clicks_on_the_map(page, (0.3, 0.3), (0.6, 0.6), (0.6, 0.3), (0.3, 0.6))
    page.keyboard.press("Enter")
    expect(page.locator(".draw-faults")).to_contain_text("The border crosses itself.")
    expect(page.get_by_role("button", name="Save")).to_be_disabled()
    page.get_by_role("button", name="Cancel").click()


def test_an_edit_outlives_the_page(visitor: Visitor) -> None:
    page = opens(visitor, "/zones")
    page.get_by_role("button", name="New zone").click()
    page.get_by_role("button", name="Circle", exact=True).click()
    clicks_on_the_map(page, (0.4, 0.4), (0.5, 0.4))
    expect(page.locator(".draw-figures")).to_contain_text("radius")
    page.get_by_label("Name", exact=True).fill("Mast")
    page.reload()
    page.get_by_role("button", name="Go on").click()
    expect(page.get_by_label("Name", exact=True)).to_have_value("Mast")
    expect(page.locator(".draw-figures")).to_contain_text("radius")
    page.get_by_role("button", name="Cancel").click()


def test_operators_look_and_change_nothing(visitor: Visitor, picture: Picture) -> None:
    page = opens(visitor, "/zones", "opal", theme="dark")
    expect(page.get_by_role("button", name="New zone")).to_be_hidden()
    page.locator(".record-row").first.click()
    expect(page.locator("#record-show")).to_contain_text("Facts as the source states them")
    expect(page.get_by_role("button", name="Edit", exact=True)).to_have_count(0)
    picture(page, "zones-dark")
    page.set_viewport_size({"width": PHONE[0], "height": PHONE[1]})
    picture(page, "zones-phone")
    page.set_viewport_size({"width": 1440, "height": 900})
    page.get_by_label("Sets and sources").check(force=True)
    expect(page.locator(".set").first).to_contain_text("zones")
