"""A campaign from the mission's page to its days: planned, planned again, deleted."""

import re

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import TOO_WIDE, stores_mission, wait_for_map

pytestmark = pytest.mark.browser


def test_targets_become_a_campaign_whose_days_are_planned_again_and_deleted(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    page.goto(stores_mission(page, "River crossing"))
    wait_for_map(page)
    page.get_by_role("button", name="More for this mission").click()
    page.get_by_role("button", name="Plan from launch sites …").click()
    form = page.get_by_role("dialog", name="Plan from launch sites over several days")
    expect(form.get_by_label("Name")).to_have_value("River crossing")
    form.get_by_label("Working day").fill("100")
    form.get_by_role("button", name="Plan the campaign").click()
    expect(form.get_by_text("At most 24.")).to_be_visible()
    form.get_by_label("Working day").fill("7")
    form.get_by_label("Greatest distance from the launch site").fill("5")
    form.get_by_role("button", name="Plan the campaign").click()

    page.wait_for_url(re.compile("/campaigns/"))
    day = page.get_by_role("region", name="Day 1")
    expect(day.locator(".campaign-visit")).not_to_have_count(0, timeout=60_000)
    expect(page.locator("#page-facts")).to_contain_text("1 day")

    page.get_by_role("button", name="Plan again").click()
    again = page.get_by_role("dialog", name="Plan this campaign again")
    expect(again.get_by_label("Working day")).to_have_value("7")
    again.get_by_label("Set-up and packing at a site").fill("30")
    before = day.locator("time").all_inner_texts()
    again.get_by_role("button", name="Plan", exact=True).click()
    expect(page.locator("#campaign-job")).to_be_hidden(timeout=60_000)
    expect(day.locator("time").last).not_to_have_text(before[-1])
    assert page.evaluate(TOO_WIDE) == []

    day.get_by_role("link").first.click()
    wait_for_map(page)
    expect(page.get_by_role("textbox", name="Name of the mission")).to_have_value("River crossing · 1")
    page.get_by_role("button", name="More for this mission").click()
    page.get_by_role("button", name="Its campaign").click()
    page.locator("html[data-loaded]").wait_for(state="attached")
    page.get_by_role("button", name="More for this campaign").click()
    page.get_by_role("button", name="Delete").click()
    page.get_by_role("dialog", name="Delete River crossing?").get_by_role("button", name="Delete").click()
    page.wait_for_url(re.compile(r"/$"))
    expect(page.get_by_role("heading", name="Campaigns")).to_be_hidden()


@pytest.mark.long
def test_a_viewer_sees_the_days_and_changes_nothing(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    page.goto(stores_mission(page, "Seen by a viewer"))
    wait_for_map(page)
    page.get_by_role("button", name="More for this mission").click()
    page.get_by_role("button", name="Plan from launch sites …").click()
    page.get_by_role("button", name="Plan the campaign").click()
    page.wait_for_url(re.compile("/campaigns/"))
    address = page.url
    expect(page.locator(".campaign-visit")).not_to_have_count(0, timeout=60_000)
    viewer = visitor.signs_in("vera", size=(390, 844), touch=True)
    viewer.goto(address)
    viewer.locator("html[data-loaded]").wait_for(state="attached")
    expect(viewer.locator(".campaign-visit")).not_to_have_count(0)
    expect(viewer.get_by_role("button", name="Plan again")).to_be_hidden()
    assert viewer.evaluate(TOO_WIDE) == []
