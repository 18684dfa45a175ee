"""The page of the API: found by filter and by address, read by keyboard, copied."""

import re

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import Visitor
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser
MAX_SCRIPTS = 4


def test_an_operation_is_found_by_the_filter_and_opened_by_keys(visitor: Visitor) -> None:
    page = visitor.opens("/api/docs")
    page.locator("html[data-loaded]").wait_for(state="attached")
    assert page.locator("script[src], link[rel=modulepreload]").count() <= MAX_SCRIPTS
    expect(page.locator(".api-group[open]")).to_have_count(0)
    page.keyboard.press("/")
    page.keyboard.type("acknowledge-ended")
    expect(page.get_by_role("status").filter(has_text=re.compile(r"^1 of \d{3}"))).to_be_visible()
    expect(page.locator(".api-operation:visible")).to_have_count(1)
    page.locator("#acknowledge_ended_alerts > summary").focus()
    page.keyboard.press("Enter")
    details = page.locator("#acknowledge_ended_alerts .api-details")
    expect(details.get_by_text("array of integer")).to_be_visible()
    expect(details.get_by_text("curl -X POST")).to_be_visible()
    assert page.url.endswith("#acknowledge_ended_alerts")
    details.get_by_label("Python").check()
    expect(details.get_by_text("requests.post(")).to_be_visible()
    expect(page.get_by_text("requests.get(", exact=False).first).to_be_visible()  # one choice for all of the page
    page.get_by_label("Filter by path or summary").fill("no such thing")
    page.get_by_role("button", name="Clear the filter").click()
    expect(page.locator(".api-group:visible")).to_have_count(page.locator(".api-group").count())


def test_the_address_of_an_operation_opens_it_and_axe_finds_nothing(visitor: Visitor) -> None:
    page = visitor.opens("/api/docs#create_mission")
    details = page.locator("#create_mission .api-details")
    expect(details.get_by_text("Line inspection").first).to_be_visible()
    expect(page.locator("#create_mission > summary")).to_be_in_viewport()
    details.get_by_text("Fields").first.click()
    expect(details.get_by_text("battery_wh", exact=True)).to_be_visible()
    assert faults(page) == []
