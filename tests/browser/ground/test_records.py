"""A curator corrects an asset, draws a zone, and takes changes back; of two at once nobody overwrites the other unseen."""

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Site, Visitor
from tests.browser.operator_map import asks, find_pickable, look_at, place_of
from tests.browser.regions import region

pytestmark = pytest.mark.browser
PHONE = (390, 844)
VOLTAGE = f"{region.voltage_kv} kV"
Picture = Callable[[Page, str], None]


def opens(visitor: Visitor, path: str, name: str = "cora", **how: object) -> Page:
    return visitor.signs_in(name, path, **how)


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


def pictures(page: Page, picture: Picture, name: str) -> None:
    """In both themes, with the map at rest."""
    for theme in ("dark", "light"):
        page.emulate_media(color_scheme=theme)
        page.locator("#map[data-idle]").wait_for(state="attached")
        picture(page, f"{name}-{theme}")


def figures(page: Page) -> Locator:
    return page.locator(".draw-figures[role=status]")


def test_a_fact_is_corrected_told_in_the_history_and_brought_back(visitor: Visitor, picture: Picture) -> None:
    page = opens(visitor, "/assets")
    finds(page, VOLTAGE, VOLTAGE)
    page.get_by_role("button", name="Edit", exact=True).click()
    page.get_by_label("Name", exact=True).fill("Northern feeder")
    page.get_by_role("textbox", name="Operator").fill("Test operator")
    expect(figures(page)).to_contain_text("points")
    pictures(page, picture, "assets-edit")
    page.get_by_role("button", name="Save").click()
    expect(page.locator(".history-list li").first).to_contain_text("Northern feeder")
    pictures(page, picture, "assets")
    page.get_by_role("button", name="Bring back what was before").first.click()
    expect(page.locator(".history-list li").first).to_contain_text("Brought back to an earlier state")
    page.keyboard.press("Escape")
    expect(page.get_by_label("Find", exact=True)).to_be_visible()


@pytest.mark.long
def test_the_register_filters_sorts_marks_edits_and_takes_back(visitor: Visitor, picture: Picture) -> None:
    page = opens(visitor, "/assets")
    total = asks(page, "/assets/summary")["total"]
    count = page.locator(".register-count")
    expect(count).to_have_text(f"{total:,} found")
    page.get_by_label("Lines", exact=True).check(force=True)
    lines = asks(page, "/assets/summary?kind=line")
    expect(count).to_have_text(f"{lines['total']:,} found")
    page.get_by_label("Voltage").select_option(str(lines["voltages"][0]["voltage_v"]))
    number = lines["voltages"][0]["count"]
    expect(count).to_have_text(f"{number:,} found")
    page.get_by_role("columnheader", name="Operator").get_by_role("button").click()
    expect(page.get_by_role("columnheader", name="Operator")).to_have_attribute("aria-sort", "ascending")
    page.get_by_label("Mark all rows shown").check()
    page.get_by_role("button", name=re.compile("^Edit .* asset")).click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("New value").fill("Register test")
    pictures(page, picture, "assets-register")
    dialog.get_by_role("button", name=re.compile("^Change ")).click()
    expect(page.locator("tr.record-row").first).to_contain_text("Register test")
    page.get_by_role("button", name="Undo", exact=True).click()
    expect(page.locator("tr.record-row").first).not_to_contain_text("Register test")
    page.get_by_role("row").get_by_role("link").first.click()
    expect(page.locator("#record-show .record-title")).to_be_visible()
    expect(page.locator("tr.record-row.chosen")).to_have_count(1)
    with page.expect_download() as loaded:
        page.get_by_role("button", name="Export").click()
        page.get_by_role("button", name="GeoPackage").click()
    assert loaded.value.suggested_filename == "assets.gpkg"


@pytest.mark.long
def test_a_phone_has_the_list_instead_of_the_table(visitor: Visitor) -> None:
    page = opens(visitor, "/assets", size=PHONE)
    expect(page.locator("button.record-row").first).to_be_visible()
    expect(page.locator(".register")).to_be_hidden()


@pytest.mark.long
def test_zones_are_a_register_too(visitor: Visitor, picture: Picture) -> None:
    page = opens(visitor, "/zones")
    counts = asks(page, "/zones/summary")
    count = page.locator(".register-count")
    expect(count).to_have_text(f"{counts['total']:,} found")
    page.get_by_label("Restriction", exact=True).select_option(counts["restrictions"][0]["value"])
    expect(count).to_have_text(f"{counts['restrictions'][0]['count']:,} found")
    page.get_by_label("Applies", exact=True).select_option("now")
    expect(page.get_by_role("row").nth(1)).to_contain_text(re.compile("always|now, until"))
    pictures(page, picture, "zones-register")
    page.get_by_role("button", name="Clear the filters").click()
    expect(count).to_have_text(f"{counts['total']:,} found")
    page.get_by_role("columnheader", name="Upper limit").get_by_role("button").click()
    expect(page.get_by_role("columnheader", name="Upper limit")).to_have_attribute("aria-sort", "ascending")
    with page.expect_download() as loaded:
        page.get_by_role("button", name="Export").click()
        page.get_by_role("button", name="CSV").click()
    assert loaded.value.suggested_filename == "zones.csv"


@pytest.mark.long
def test_several_zones_are_corrected_together_unless_one_changed_meanwhile(visitor: Visitor, picture: Picture) -> None:
    page = opens(visitor, "/zones")
    rows = page.locator("tr.record-row")
    name = rows.first.get_by_role("link").inner_text()
    reasons = [row.get_by_role("cell").nth(3).inner_text() for row in (rows.nth(0), rows.nth(1))]
    zone = str(rows.first.get_attribute("data-id"))

    def corrects(meanwhile: Callable[[], None]) -> None:
        for row in (0, 1):
            rows.nth(row).get_by_role("checkbox").check()
        page.get_by_role("button", name="Edit 2 zones").click()
        dialog = page.get_by_role("dialog")
        dialog.get_by_label("Fact to change").select_option("reason")
        dialog.get_by_label("Noise", exact=True).check()
        meanwhile()
        dialog.get_by_role("button", name="Change 2 zones").click()

    corrects(lambda: a_user_writes(page, zone, path="/zones", name=f"{name} (new)"))
    expect(page.get_by_text("Nothing was changed")).to_be_visible()
    expect(rows.first).to_contain_text(f"{name} (new)")  # read again
    visitor.complaints.clear()  # the browser tells of the answer 409, which is meant
    corrects(lambda: pictures(page, picture, "zones-edit-several"))
    expect(rows.nth(0)).to_contain_text("Noise")
    expect(rows.nth(1)).to_contain_text("Noise")
    page.get_by_role("button", name="Undo", exact=True).click()
    for row, reason in enumerate(reasons):
        expect(rows.nth(row).get_by_role("cell").nth(3)).to_have_text(reason)
    a_user_writes(page, zone, path="/zones", name=name)


def a_user_writes(page: Page, key: str, path: str = "/assets", **facts: object) -> None:
    """Another change of the asset or zone, past this page."""
    change = """async ([path, facts]) => {
        const api = await import("/static/js/api.js");
        await api.patch(path, facts, { headers: { "If-Match": (await api.get(path)).etag } });
    }"""
    page.evaluate(change, [f"{path}/{key}", facts])


def test_the_second_of_two_curators_is_asked_and_overwrites_nothing_unseen(visitor: Visitor) -> None:
    page = opens(visitor, "/assets")
    finds(page, VOLTAGE, VOLTAGE)
    page.get_by_role("button", name="Edit", exact=True).click()
    asset = page.url.split("id=")[1]
    a_user_writes(page, asset, operator="Theirs")
    page.get_by_role("textbox", name="Operator").fill("Mine")
    page.get_by_role("button", name="Save").click()
    dialog = page.get_by_role("dialog")
    expect(dialog).to_contain_text("Theirs → Mine")
    dialog.get_by_role("button", name="Use theirs").click()
    expect(page.locator("#record-show")).to_contain_text("Theirs")
    visitor.complaints.clear()  # the browser tells of the answer 412, which is meant


@pytest.mark.long
def test_what_is_stored_over_a_change_of_others_leaves_their_other_facts(visitor: Visitor) -> None:
    page = opens(visitor, "/assets")
    finds(page, VOLTAGE, VOLTAGE)
    page.get_by_role("button", name="Edit", exact=True).click()
    asset = page.url.split("id=")[1]
    a_user_writes(page, asset, operator="Theirs", name="Their name")
    page.get_by_role("textbox", name="Operator").fill("Mine")
    page.get_by_role("button", name="Save").click()
    dialog = page.get_by_role("dialog")
    expect(dialog.locator("dd").last).to_have_text("Theirs → Mine")
    expect(dialog.locator("dl").last.locator("dd")).to_have_count(1)
    dialog.get_by_role("button", name="Overwrite").click()
    expect(page.locator(".history-list li").first).to_contain_text("Theirs → Mine")
    stored = asks(page, f"/assets/{asset}")["properties"]
    assert (stored["operator"], stored["name"]) == ("Mine", "Their name")
    visitor.complaints.clear()  # the browser tells of the answer 412, which is meant


@pytest.mark.long
def test_a_new_line_takes_the_exact_places_of_what_it_snaps_to_unless_ctrl_is_held(visitor: Visitor) -> None:
    page = opens(visitor, "/assets")
    tower = find_pickable(page).tower
    longitude, latitude = tower["geometry"]["coordinates"]
    place = look_at(page, [longitude, latitude], 16)
    page.get_by_role("button", name="New asset").click()
    page.get_by_role("button", name="Power line").click()
    page.mouse.move(place["x"] + 5, place["y"] - 4)
    page.mouse.click(place["x"] + 5, place["y"] - 4)
    page.get_by_text("Points", exact=True).click()
    expect(page.get_by_label("Longitude of point 1")).to_have_value(str(longitude))
    expect(page.get_by_label("Latitude of point 1")).to_have_value(str(latitude))
    page.keyboard.press("Control+z")
    page.keyboard.down("Control")
    page.mouse.click(place["x"] + 5, place["y"] - 4)
    page.keyboard.up("Control")
    expect(page.get_by_label("Longitude of point 1")).not_to_have_value(str(longitude))
    page.get_by_role("button", name="Cancel").click()


@pytest.mark.long
def test_a_shape_is_drawn_and_corrected_without_a_pointer(visitor: Visitor) -> None:
    page = opens(visitor, "/zones")
    page.get_by_role("button", name="New zone").click()
    page.get_by_role("button", name="Area", exact=True).click()
    page.get_by_text("Points", exact=True).click()
    north = region.at(0.02, 0.02)[1]
    for longitude, latitude in (region.at(0, 0), region.at(0.02, 0), region.at(0.02, 0.02)):
        page.get_by_role("button", name="Add a point in the middle of the map").press("Enter")
        row = page.locator(".draw-vertices tbody tr").last
        row.get_by_role("spinbutton").first.fill(str(longitude))
        row.get_by_role("spinbutton").last.fill(str(latitude))
        row.get_by_role("spinbutton").last.press("Tab")
    page.get_by_role("button", name="Finish").press("Enter")
    expect(figures(page)).to_contain_text("3 points")
    page.get_by_role("button", name="Point 3", exact=True).press("Enter")
    page.keyboard.press("Shift+ArrowUp")
    moved = float(page.get_by_label("Latitude of point 3").input_value())
    assert moved > north
    page.keyboard.press("Control+z")
    expect(page.get_by_label("Latitude of point 3")).to_have_value(str(north))
    page.get_by_label("Name", exact=True).fill("By hand")
    page.get_by_role("button", name="Save").press("Enter")
    expect(page.locator("#record-show")).to_contain_text("By hand")
    page.get_by_role("button", name="Delete").click()


@pytest.mark.long
def test_a_point_is_dragged_the_whole_is_moved_and_a_dropped_edit_comes_back(visitor: Visitor) -> None:
    page = opens(visitor, "/zones")
    zone = asks(page, "/zones?limit=1")["features"][0]
    page.locator(f".record-row[data-id='{zone['id']}']").click()
    page.locator("#map[data-idle]").wait_for(state="attached")
    page.get_by_role("button", name="Edit", exact=True).click()
    page.get_by_text("Points", exact=True).click()
    position = page.get_by_role("spinbutton", name="of point 1")
    before = position.evaluate_all("(inputs) => inputs.map((input) => Number(input.value))")
    place = place_of(page, before)

    def drags(right: int, down: int) -> list[float]:
        page.mouse.move(place["x"], place["y"])
        page.mouse.down()
        page.mouse.move(place["x"] + right, place["y"] + down, steps=4)
        page.mouse.up()
        return position.evaluate_all("(inputs) => inputs.map((input) => Number(input.value))")

    east, north = drags(25, -20)
    assert east > before[0]
    assert north > before[1]
    page.keyboard.press("Control+z")
    second = page.get_by_label("Longitude of point 2")
    was = second.input_value()
    page.get_by_role("button", name="Move", exact=True).click()
    moved = drags(40, 0)
    assert moved[0] > before[0]
    assert abs(float(second.input_value()) - float(was) - (moved[0] - before[0])) < 1e-6
    page.get_by_role("button", name="Cancel").click()
    page.get_by_role("button", name="Undo", exact=True).click()
    expect(page.get_by_label("Longitude of point 1")).to_have_value(str(moved[0]))
    page.get_by_role("button", name="Cancel").click()
    assert asks(page, f"/zones/{zone['id']}")["geometry"] == zone["geometry"]


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
    expect(figures(page)).to_contain_text("7 points")
    for _ in range(4):
        page.keyboard.press("Control+z")
    expect(figures(page)).to_contain_text("4 points")
    for _ in range(4):
        page.keyboard.press("Control+Shift+z")
    expect(figures(page)).to_contain_text("7 points")
    page.get_by_label("Name", exact=True).fill("Works at the yard")
    page.get_by_label("Upper limit, counted from").select_option("AGL")
    page.get_by_label("Upper limit, value").fill("120")
    pictures(page, picture, "zones-draw")
    page.get_by_role("switch", name="Always").click()
    page.get_by_label("Ends", exact=True).select_option("SS")
    page.locator("#side-scroll").evaluate("(panel) => (panel.scrollTop = panel.scrollHeight)")
    pictures(page, picture, "zone-schedule")
    page.get_by_role("button", name="Save").click()
    shown = page.locator("#record-show")
    expect(shown).to_contain_text("Mon to Fri 08:00 to sunset")
    expect(shown).to_contain_text("120 m above ground")
    pictures(page, picture, "zones")
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


@pytest.mark.long
def test_an_edit_outlives_the_page(visitor: Visitor) -> None:
    page = opens(visitor, "/zones")
    page.get_by_role("button", name="New zone").click()
    page.get_by_role("button", name="Circle", exact=True).click()
    clicks_on_the_map(page, (0.4, 0.4), (0.5, 0.4))
    expect(figures(page)).to_contain_text("radius")
    page.get_by_label("Name", exact=True).fill("Mast")
    page.reload()
    page.get_by_role("button", name="Go on").click()
    expect(page.get_by_label("Name", exact=True)).to_have_value("Mast")
    expect(figures(page)).to_contain_text("radius")
    page.get_by_role("button", name="Cancel").click()


@pytest.mark.long
def test_operators_look_and_change_nothing(visitor: Visitor, picture: Picture) -> None:
    page = opens(visitor, "/zones", "opal", theme="dark")
    expect(page.get_by_role("button", name="New zone")).to_be_hidden()
    page.locator(".record-row").first.click()
    expect(page.locator("#record-show")).to_contain_text("Data as published by its source")
    expect(page.get_by_role("button", name="Edit", exact=True)).to_have_count(0)
    page.set_viewport_size({"width": PHONE[0], "height": PHONE[1]})
    pictures(page, picture, "zones-phone")
    page.set_viewport_size({"width": 1440, "height": 900})
    page.get_by_label("Sets and sources").check(force=True)
    expect(page.locator(".set").first).to_contain_text("zones")


INSPECT_HALF = """
from django.contrib.gis.geos import LineString
from django.utils import timezone
from inspection.models import Asset
from inspection.selectors.picking import parts_of_asset
from missions.models import InspectionTarget, Mission, MissionUav, TargetState, Uav
from workspace.models import User

opal = User.objects.get(username="opal")
line = Asset.objects.get(pk={line})
mission = Mission.objects.create(organisation=opal.organisation, author=opal, name="Spring round")
uav = Uav.objects.create(organisation=opal.organisation, name="Inspector {line}", location=line.centre)
MissionUav.objects.create(mission=mission, sequence=0, uav=uav, name=uav.name, start=line.centre, cruise_speed_mps=10.0)
parts = parts_of_asset(line, 1_000.0)
for sequence, part in enumerate(parts[: len(parts) // 2]):
    stretch = LineString(part.start, part.end, srid=4326)
    InspectionTarget.objects.create(
        mission=mission, sequence=sequence, asset=line, label="", stretch=stretch, state=TargetState.COMPLETE, state_at=timezone.now()
    )
"""


def test_which_parts_of_a_line_were_inspected_is_seen_and_the_rest_planned(visitor: Visitor, site: Site) -> None:
    page = visitor.signs_in("opal")
    lines = asks(page, "/assets?kind=line&flyable=true&sort=-length&limit=1")["features"]
    site.does(INSPECT_HALF.format(line=lines[0]["id"]))
    parts = asks(page, f"/assets/{lines[0]['id']}/parts")["parts"]
    page.goto(f"/assets?id={lines[0]['id']}")
    expect(page.get_by_role("img", name=re.compile(r"^Inspected: [\d.]+ km of [\d.]+ km, \d\d %$"))).to_be_visible()
    part = page.locator(".asset-missions li").filter(has_text=re.compile(r"km 0\.0–[\d.]+"))
    expect(part.get_by_role("link", name="Spring round")).to_be_visible()

    page.get_by_role("button", name="Layers").click()
    with page.expect_response(lambda answer: "/tiles/inspections/" in answer.url and answer.ok):
        page.get_by_role("checkbox", name="Last inspections").check()
    page.keyboard.press("Escape")
    expect(page.locator("#legend")).to_contain_text("Inspected in the last 30 days")

    page.get_by_role("button", name=re.compile("^Plan the .* not inspected yet$")).click()
    page.wait_for_url(re.compile("/missions/"))
    expect(page.locator("#target-count")).to_have_text(f"{len(parts) - len(parts) // 2}")
