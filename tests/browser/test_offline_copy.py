"""After one visit an approved mission opens without a network, marked as a copy and without commands; nothing is left after signing out."""

import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import BrowserContext, Page, expect

from tests.browser.conftest import Visitor
from tests.browser.flying.frozen_line import line_to
from tests.browser.operator_map import TOO_WIDE, wait_for_map
from tests.browser.pictures import Picture
from tests.browser.simulated_mission import beside, retires, simulated_uavs, two_towers
from tests.browser.test_accessibility import faults
from tests.browser.test_fleet import writes

pytestmark = pytest.mark.browser

NAME = "Belt without a network"
COPY_FROM = re.compile(r"Offline copy from \d\d:\d\d")
IS_KEPT = """async (addresses) => {
    for (const name of (await caches.keys()).filter((one) => one.startsWith("spanwise-copy-"))) {
        const cache = await caches.open(name);
        const kept = (await cache.keys()).map(({ url }) => new URL(url).pathname);
        if (addresses.every((address) => kept.includes(address)) && kept.some((one) => one.includes("/tiles/15/"))) return true;
    }
    return false;
}"""
KEPT_OF_USERS = """async () => {
    const found = [];
    for (const name of await caches.keys()) {
        if (!name.startsWith("spanwise-copy-")) continue;
        for (const { url } of await (await caches.open(name)).keys()) found.push(new URL(url).pathname);
    }
    return found;
}"""


@pytest.fixture
def mission(visitor: Visitor) -> Iterator[str]:
    """The key of an approved mission of two simulated UAVs with a rally point."""
    page = visitor.signs_in("ada")
    towers = two_towers(page)
    at = towers[0]["geometry"]["coordinates"]
    uavs = simulated_uavs(page, "Dunlin", "Knot", at=at)
    body = {
        "name": NAME, "uavs": [{"id": uav, "most_targets": 1} for uav in uavs], "targets": [{"asset": tower["id"]} for tower in towers],
        "objective": "makespan", "return_to_start": True, "plan": True,
        "lost_link": {"behaviour": "return", "rally_points": [beside(at, 3)]},
    }  # fmt: skip
    key = str(writes(page, "POST", "/missions", body)["id"])
    writes(page, "POST", f"/missions/{key}/approve")
    page.close()
    yield key
    visitor.complaints.clear()  # of what could not be reached
    retires(visitor.signs_in("ada"), uavs)


def with_a_worker(visitor: Visitor, **options: Any) -> BrowserContext:
    return visitor.new_context(service_workers="allow", **options)


def signed_in(visitor: Visitor, context: BrowserContext, name: str = "opal") -> Page:
    visitor.signs_in(name).close()
    context.add_cookies(visitor.site.came_in[name][1])
    page = context.new_page()
    page.set_default_timeout(45_000)
    return page


def waits_until(page: Page, fact: str, argument: Any = None) -> None:
    """`fact` answers with a promise, which wait_for_function takes for true."""
    for _try in range(90):
        if page.evaluate(fact, argument):
            return
        page.wait_for_timeout(500)
    raise AssertionError(fact)


def visits(page: Page, mission: str) -> None:
    """Open the page of the mission's flight once, and wait until the browser has kept it."""
    page.goto(f"/missions/{mission}/fly")
    wait_for_map(page)
    waits_until(page, IS_KEPT, [f"/missions/{mission}", f"/missions/{mission}/fly", f"/api/v1/missions/{mission}"])


def test_after_one_visit_an_approved_mission_opens_without_a_network(visitor: Visitor, mission: str, picture: Picture) -> None:
    context = with_a_worker(visitor, viewport={"width": 390, "height": 844}, has_touch=True)
    page = signed_in(visitor, context)
    visits(page, mission)
    context.set_offline(True)

    page.reload()
    wait_for_map(page)
    expect(page.locator(".copy-banner")).to_contain_text(COPY_FROM)
    expect(page.get_by_role("heading", name=NAME)).to_be_visible()
    approved = page.get_by_role("region", name="Approved mission")
    expect(approved).to_contain_text("Dunlin")
    expect(approved).to_contain_text("Rally point R1")
    expect(approved).to_contain_text("Approved by ada")
    expect(page.get_by_role("img", name="Rally point R1")).to_be_visible()
    expect(page.get_by_role("img", name=re.compile("^Target "))).not_to_have_count(0)
    expect(page.get_by_role("button", name="Return all")).to_have_count(0)  # of no UAV is known that it flies
    expect(page.get_by_text("commands are off until it answers")).to_be_visible()
    expect(page.locator("#right-parts")).to_be_hidden()  # no alerts are known, which is not: no alerts
    expect(page.locator("#uav-cards .card")).to_have_count(0)
    assert faults(page) == []
    picture(page, "offline-copy-fly")

    page.goto(f"/missions/{mission}")
    wait_for_map(page)
    expect(page.locator(".copy-banner")).to_contain_text(COPY_FROM)
    expect(page.get_by_role("textbox", name="Name of the mission")).to_have_value(NAME)
    expect(page.get_by_role("region", name="Approved mission")).to_contain_text("Knot")
    expect(page.get_by_role("img", name="Rally point R1")).to_be_visible()
    assert page.evaluate(TOO_WIDE) == []
    picture(page, "offline-copy-plan")

    context.set_offline(False)
    expect(page.locator("html:not([data-offline-copy])[data-loaded]")).to_be_attached()  # by itself
    expect(page.locator(".copy-banner")).to_have_count(0)


@pytest.mark.long
def test_a_page_that_was_not_kept_names_the_copies_that_are_there(visitor: Visitor, mission: str) -> None:
    context = with_a_worker(visitor)
    page = signed_in(visitor, context)
    visits(page, mission)
    context.set_offline(True)
    page.goto("/zones")
    expect(page.get_by_role("heading", name="The server cannot be reached.")).to_be_visible()
    row = page.get_by_role("listitem").filter(has_text=NAME)
    expect(row).to_contain_text(COPY_FROM)
    assert faults(page) == []
    row.get_by_role("link", name=f"Fly: {NAME}").click()
    wait_for_map(page)
    expect(page.locator(".copy-banner")).to_contain_text(COPY_FROM)


@pytest.mark.long
def test_after_signing_out_nothing_opens_without_a_network(visitor: Visitor, mission: str) -> None:
    context = with_a_worker(visitor)
    page = signed_in(visitor, context, "rory")
    visits(page, mission)
    page.get_by_role("button", name=re.compile("^Account of")).click()
    page.get_by_role("button", name="Sign out").click()
    expect(page).to_have_url(re.compile("/sign-in"))
    visitor.site.came_in.pop("rory", None)  # that session is over
    assert page.evaluate(KEPT_OF_USERS) == []
    context.set_offline(True)
    page.goto(f"/missions/{mission}/fly")
    expect(page.get_by_role("heading", name="The server cannot be reached.")).to_be_visible()
    expect(page.get_by_text(NAME)).to_have_count(0)


@pytest.mark.long
def test_signing_out_without_a_network_empties_the_copy(visitor: Visitor, mission: str) -> None:
    context = with_a_worker(visitor)
    page = signed_in(visitor, context)
    visits(page, mission)
    context.set_offline(True)
    page.reload()
    wait_for_map(page)
    page.get_by_role("button", name=re.compile("^Account of")).click()
    page.get_by_role("button", name="Sign out").click()
    expect(page.get_by_text("The offline copies on this device are deleted.")).to_be_visible()
    assert page.evaluate(KEPT_OF_USERS) == []


@pytest.mark.long
def test_another_user_of_the_browser_gets_nothing_of_the_copy(visitor: Visitor, mission: str) -> None:
    context = with_a_worker(visitor)
    page = signed_in(visitor, context)
    visits(page, mission)
    visitor.signs_in("vera").close()
    context.clear_cookies()
    context.add_cookies(visitor.site.came_in["vera"][1])
    page.goto("/")
    page.locator("html[data-loaded]").wait_for(state="attached")
    waits_until(page, f"async () => (await ({KEPT_OF_USERS})()).length === 0")


@pytest.mark.long
def test_a_line_that_stands_still_ends_in_the_copy_and_not_in_waiting(visitor: Visitor, mission: str) -> None:
    context = with_a_worker(visitor)
    page = signed_in(visitor, context)
    with line_to(visitor.site.address) as line:
        cookies = [{**cookie, "domain": "127.0.0.1"} for cookie in visitor.site.came_in["opal"][1]]
        context.add_cookies(cookies)
        page.goto(f"{line.address}/missions/{mission}/fly")
        wait_for_map(page)
        waits_until(page, IS_KEPT, [f"/missions/{mission}/fly"])
        line.freeze()
        page.reload()
        wait_for_map(page)
        expect(page.locator(".copy-banner")).to_contain_text(COPY_FROM)
        line.repair()
        page.close()


@pytest.mark.long
def test_what_is_not_approved_any_more_is_not_kept_after_the_next_page(visitor: Visitor, mission: str) -> None:
    context = with_a_worker(visitor)
    page = signed_in(visitor, context)
    visits(page, mission)
    other = visitor.signs_in("ada")
    writes(other, "POST", f"/missions/{mission}/revoke", {"reason": "the line is being worked on"})
    page.evaluate("() => localStorage.clear()")  # when it was asked last: ten minutes have passed
    page.goto("/")
    waits_until(page, f"async (mission) => !(await ({KEPT_OF_USERS})()).some((address) => address.includes(mission))", mission)
