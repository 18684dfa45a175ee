"""Two people in one mission: they see each other, their changes come together, and nobody overwrites what they have not seen."""

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, at_zoom, stores_mission, targets, wait_for_map
from tests.browser.planning.test_planning import opens_mission as opens_planned
from tests.browser.planning.test_unsaved_changes import forgives, opens_mission, picks_from_the_search, removes_first_target
from tests.browser.regions import region

pytestmark = pytest.mark.browser

SAVED = re.compile(r"^Saved \d\d:\d\d$")


def renames(page: Page, name: str) -> None:
    page.get_by_role("textbox", name="Name of the mission").fill(name)
    page.keyboard.press("Tab")


def both_open(visitor: Visitor, address: str) -> tuple[Page, Page]:
    mine, theirs = visitor.signs_in("opal"), visitor.signs_in("rory")
    opens_mission(mine, address)
    opens_mission(theirs, address)
    return mine, theirs


@pytest.mark.long
def test_what_one_changes_arrives_at_the_other_by_itself(visitor: Visitor) -> None:
    address = stores_mission(visitor.signs_in("opal"), "Seen by two")
    mine, theirs = both_open(visitor, address)
    expect(theirs.locator("#others")).to_have_text("Also open: opal")
    expect(mine.locator("#others")).to_have_text("Also open: rory")
    removes_first_target(mine)
    expect(mine.locator("#save-state")).to_have_text(SAVED)
    expect(theirs.locator("#target-list .target")).to_have_count(1)
    expect(theirs.get_by_text("opal: 1 target removed.")).to_be_visible()
    picks_from_the_search(theirs, f"{region.voltage_kv} kV")
    expect(mine.locator("#target-list .target")).to_have_count(2)
    mine.get_by_title("Undo (Ctrl+Z)").click()  # one's own step alone
    expect(mine.locator("#target-list .target")).to_have_count(3)
    expect(theirs.locator("#target-list .target")).to_have_count(3)
    mine.goto("/")
    expect(theirs.locator("#others")).to_be_hidden()


@pytest.mark.long
def test_a_save_takes_no_focus_from_the_notices(visitor: Visitor) -> None:
    mine = visitor.signs_in("opal")
    opens_planned(mine, "Out of reach", more=[{"position": region.far_away}])
    remove = mine.locator("#notices").get_by_role("button", name="Remove it")
    remove.focus()
    theirs = visitor.signs_in("rory")
    opens_mission(theirs, mine.url.split("#")[0])
    renames(theirs, "Out of reach, seen by two")
    expect(mine.get_by_role("textbox", name="Name of the mission")).to_have_value("Out of reach, seen by two")
    expect(remove).to_be_focused()


@pytest.mark.long
def test_changes_of_different_parts_at_the_same_time_come_together(visitor: Visitor) -> None:
    address = stores_mission(visitor.signs_in("opal"), "Different parts")
    mine, theirs = both_open(visitor, address)
    mine.route("**/api/v1/missions/**", lambda route: route.abort())
    removes_first_target(mine)
    expect(mine.locator("#save-state")).to_contain_text("Not saved")
    renames(theirs, "Different parts, checked")
    expect(theirs.locator("#save-state")).to_have_text(SAVED)
    mine.unroute("**/api/v1/missions/**")
    expect(mine.get_by_role("textbox", name="Name of the mission")).to_have_value("Different parts, checked")
    expect(mine.locator("#save-state")).to_have_text(SAVED)
    expect(theirs.locator("#target-list .target")).to_have_count(1)
    stored = asks(mine, address)
    assert (stored["name"], len(stored["targets"])) == ("Different parts, checked", 1)
    visitor.complaints.clear()  # of the requests that were cut


@pytest.mark.long
@pytest.mark.parametrize("way", ["both", "top", "theirs", "copy"])
def test_where_both_changed_the_same_the_operator_sees_both_and_decides(
    visitor: Visitor, picture: Callable[[Page, str], None], way: str
) -> None:
    address = stores_mission(visitor.signs_in("opal"), "Contested")
    mine, theirs = both_open(visitor, address)
    mine.route("**/api/v1/missions/**", lambda route: route.abort())
    renames(mine, "Mine")
    expect(mine.locator("#save-state")).to_contain_text("Not saved")
    renames(theirs, "Theirs")
    removes_first_target(theirs)
    expect(theirs.locator("#save-state")).to_have_text(SAVED)
    expect(theirs.locator("#target-list .target")).to_have_count(1)
    mine.unroute("**/api/v1/missions/**")
    expect(mine.get_by_text(re.compile(r"Your changes are from before rory’s save at \d\d:\d\d\."))).to_be_visible()
    assert asks(mine, address)["name"] == "Theirs"  # nothing was overwritten

    mine.get_by_role("button", name="See both").click()
    dialog = mine.get_by_role("dialog", name="Both versions of this mission")
    expect(dialog.get_by_role("row", name="Name")).to_contain_text("Mine")
    expect(dialog.get_by_role("row", name="Name")).to_contain_text("Theirs")
    expect(dialog.get_by_role("row", name="Targets")).to_contain_text("removed: ")
    picture(mine, "together-both-versions")
    name = mine.get_by_role("textbox", name="Name of the mission")
    if way == "top":
        dialog.get_by_role("button", name="Put mine on top").click()
        expect(mine.locator("#save-state")).to_have_text(SAVED)
        assert (asks(mine, address)["name"], len(asks(mine, address)["targets"])) == ("Mine", 2)
    elif way == "theirs":
        dialog.get_by_role("button", name="Use theirs").click()
        expect(name).to_have_value("Theirs")
        expect(mine.locator("#target-list .target")).to_have_count(1)
        mine.get_by_role("button", name="Back to mine").click()
        expect(name).to_have_value("Mine")
        expect(mine.locator("#target-list .target")).to_have_count(2)
    elif way == "copy":
        dialog.get_by_role("button", name="Keep mine as a copy").click()
        expect(mine.get_by_text("“Mine (copy)” is saved.")).to_be_visible()
        assert address not in mine.url
        assert (asks(mine, address)["name"], len(targets(mine))) == ("Theirs", 2)
    else:
        dialog.get_by_role("button", name="Put together").click()
        expect(mine.locator("#save-state")).to_have_text(SAVED)
        assert (asks(mine, address)["name"], len(asks(mine, address)["targets"])) == ("Mine", 1)
    visitor.complaints.clear()


@pytest.mark.long
def test_a_mission_that_somebody_deletes_can_be_brought_back_from_the_open_page(visitor: Visitor) -> None:
    address = stores_mission(visitor.signs_in("opal"), "Deleted by another")
    mine, theirs = both_open(visitor, address)
    theirs.get_by_role("button", name="More for this mission").click()
    theirs.get_by_role("button", name="Delete").click()
    expect(theirs.get_by_text("“Deleted by another” is deleted.")).to_be_visible()
    expect(mine.get_by_text("The mission has been deleted.")).to_be_visible()
    removes_first_target(mine)
    expect(mine.locator("#save-state")).to_contain_text("Not saved")
    forgives(visitor, 404)
    mine.get_by_role("button", name="Bring it back").click()
    expect(mine.get_by_text("the mission has been deleted", exact=False)).to_be_hidden()
    expect(mine.locator("#save-state")).to_have_text(SAVED)
    stored = asks(mine, address)
    assert (stored["name"], len(stored["targets"])) == ("Deleted by another", 1)
    visitor.complaints.clear()


@pytest.mark.long
def test_the_history_says_in_words_who_did_what(visitor: Visitor, picture: Callable[[Page, str], None]) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, stores_mission(page, "Told later"))
    removes_first_target(page)
    expect(page.locator("#save-state")).to_have_text(SAVED)
    page.get_by_role("button", name="More for this mission").click()
    page.get_by_role("button", name="History").click()
    lines = page.get_by_role("dialog", name="History of “Told later”").get_by_role("list", name="History").locator("> li")
    expect(lines).to_have_count(4)
    expect(lines.nth(0)).to_contain_text("Planned opal")  # a small change is planned again at once
    expect(lines.nth(1)).to_contain_text("Changed opal")
    expect(lines.nth(1)).to_contain_text("1 target removed: ")
    expect(lines.nth(2)).to_contain_text("Planned opal")
    expect(lines.nth(3)).to_contain_text("2 targets, 2 UAVs")
    picture(page, "mission-history")


@pytest.mark.long
def test_the_address_to_share_leads_to_the_same_mission_and_place(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    address = stores_mission(page, "Shared")
    view = at_zoom(13.5, region.at(0.05, -0.05))
    opens_mission(page, f"{address}{view}")
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.get_by_role("button", name="More for this mission").click()
    page.get_by_role("button", name="Copy link").click()
    expect(page.get_by_text("Link copied.")).to_be_visible()
    shared = page.evaluate("navigator.clipboard.readText()")
    assert f"{address}#map=13.5/" in shared
    other = opens_mission(visitor.signs_in("vera"), shared)
    expect(other.get_by_role("textbox", name="Name of the mission")).to_have_value("Shared")
    expect(other).to_have_url(re.compile(re.escape(view.rpartition("/")[0])))


def test_a_zone_over_a_leg_is_told_to_the_open_page_with_a_way_out(visitor: Visitor, picture: Callable[[Page, str], None]) -> None:
    page = visitor.signs_in("opal")
    address = stores_mission(page, "Under a new zone")
    opens_mission(page, address)
    expect(page.locator("#save-state")).to_have_text(SAVED)
    route = next(route for route in asks(page, address)["plan"]["routes"] if route["geometry"])
    longitude, latitude = route["geometry"]["coordinates"][len(route["geometry"]["coordinates"]) // 2]
    ring = [[longitude + x * 0.0008, latitude + y * 0.0006] for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))]
    curator = visitor.signs_in("cora")
    headers = {"X-CSRFToken": next(cookie["value"] for cookie in curator.context.cookies() if cookie["name"] == "csrftoken")}
    polygon = {"type": "Polygon", "coordinates": [ring]}
    zone = curator.request.post("/api/v1/zones", data={"name": "Fire brigade", "geometry": polygon}, headers=headers)
    assert zone.status == 201, zone.text()
    try:
        expect(page.get_by_text("A zone changed since this was planned.")).to_be_visible()
        expect(page.locator(".causes")).to_contain_text(re.compile(r"Fire brigade touches the (leg|route)"))
        page.locator("#notices").get_by_role("button", name="See the place").first.click()
        expect(page).to_have_url(re.compile(r"#map=1[4-9]"))
        expect(page.locator("#notices").get_by_role("button", name="Plan again")).to_be_visible()
        picture(page, "mission-stale")
        assert asks(page, address)["stale_causes"][0]["what"] == "zone"
    finally:
        curator.request.delete(f"/api/v1/zones/{zone.json()['id']}", headers=headers | {"If-Match": "*"})
    wait_for_map(page)
