"""The network is cut in the middle of editing: it is said clearly, work goes on, and nothing is lost."""

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Page, Route, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, chooses_type, stores_mission, targets, unlimited_type, wait_for_map
from tests.browser.planning.test_unsaved_changes import opens_mission, picks_from_the_search, removes_first_target
from tests.browser.regions import region

pytestmark = pytest.mark.browser

SAVED = re.compile(r"^Saved \d\d:\d\d$")
CUT = re.compile(r"ERR_INTERNET_DISCONNECTED|ERR_FAILED|ERR_NETWORK|Failed to fetch|AJAXError|status of 404")


def forgives_the_cut(visitor: Visitor) -> None:
    assert all(CUT.search(words) for words in visitor.complaints), visitor.complaints
    visitor.complaints.clear()


def test_work_goes_on_without_a_network_and_is_saved_when_it_is_back(visitor: Visitor, picture: Callable[[Page, str], None]) -> None:
    page = visitor.signs_in("opal")
    address = stores_mission(page, "In a tunnel")
    opens_mission(page, address)
    expect(page.locator("#save-state")).to_have_text(SAVED)
    page.context.set_offline(True)
    expect(page.get_by_text("You can go on: what you change is kept in this browser")).to_be_visible()
    removes_first_target(page)
    page.get_by_role("textbox", name="Name of the mission").fill("Out of the tunnel")
    page.keyboard.press("Tab")
    expect(page.locator("#save-state")).to_have_text("Not saved: the server cannot be reached")
    picture(page, "offline-light")
    page.context.set_offline(False)
    expect(page.get_by_text("Connected again. Everything is saved.")).to_be_visible()
    expect(page.locator("#save-state")).to_have_text(SAVED)
    expect(page.get_by_text("The server cannot be reached.")).to_have_count(0)
    stored = asks(page, address)
    assert (stored["name"], len(stored["targets"])) == ("Out of the tunnel", 1)
    forgives_the_cut(visitor)


@pytest.mark.long
def test_a_page_that_dies_without_a_network_finds_its_changes_again(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    address = stores_mission(page, "Battery empty")
    opens_mission(page, address)
    page.context.set_offline(True)
    removes_first_target(page)
    expect(page.locator("#save-state")).to_contain_text("Not saved")
    page.wait_for_function("() => Object.keys(localStorage).some((key) => key.startsWith('spanwise.draft.'))")
    left = targets(page)
    context = page.context
    page.close()
    visitor.complaints.clear()
    context.set_offline(False)
    again = opens_mission(context.new_page(), address)
    expect(again.get_by_text("Your unsaved changes are back.")).to_be_visible()
    assert targets(again) == left
    expect(again.locator("#save-state")).to_have_text(SAVED)
    assert len(asks(again, address)["targets"]) == 1


@pytest.mark.long
def test_a_save_whose_answer_is_lost_makes_one_mission(visitor: Visitor) -> None:
    page = opens_mission(visitor.signs_in("opal"), "/missions/new")
    picks_from_the_search(page, f"{region.voltage_kv} kV")
    page.get_by_role("textbox", name="Name of the mission").fill("Answer lost")

    def stored_and_cut(route: Route) -> None:
        if route.request.method == "POST":
            route.fetch()
        route.abort()

    page.route(re.compile(r"/api/v1/missions$"), stored_and_cut)
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.get_by_text("Not saved: the server cannot be reached.")).to_be_visible()
    page.unroute(re.compile(r"/api/v1/missions$"))
    page.get_by_role("button", name="Try now").click()
    expect(page.locator("#save-state")).to_have_text(SAVED)
    assert asks(page, "/missions?text=Answer lost")["total"] == 1
    forgives_the_cut(visitor)


def test_a_new_mission_stores_itself_with_its_first_plan_and_then_each_change(visitor: Visitor) -> None:
    page = opens_mission(visitor.signs_in("opal"), "/missions/new")
    picks_from_the_search(page, "bridge")
    expect(page.locator("#save-state")).to_have_text("Kept in this browser until it is planned or saved")
    unlimited_type(page)
    page.get_by_role("button", name="Add a UAV").click()
    page.locator("#map canvas").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("Name").fill("Osprey")
    chooses_type(page)
    dialog.get_by_role("button", name="Add").click()
    expect(page.get_by_role("checkbox", name="Osprey")).to_be_checked()
    page.keyboard.press("p")
    expect(page.get_by_text(re.compile("is saved. From now on it saves itself"))).to_be_visible()
    expect(page).to_have_url(re.compile(r"/missions/[0-9a-f-]{36}"))
    address = "/" + "/".join(page.url.split("#")[0].split("/")[-2:])
    expect(page.get_by_role("textbox", name="Name of the mission")).not_to_have_value("")
    assert asks(page, address)["state"] == "planned"
    with page.expect_response(lambda answer: answer.request.method == "PATCH"):
        picks_from_the_search(page, f"{region.voltage_kv} kV")
    expect(page.locator("#save-state")).to_have_text(SAVED)
    assert f"{len(asks(page, address)['targets'])}" == page.locator("#target-count").text_content() != "1"
    wait_for_map(page)
