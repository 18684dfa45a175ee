"""Picking what is inspected: by lasso, stretch, railway, search and list; tasks, several at once, undo, saved selections."""

import re
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, find_pickable, look_at, targets, wait_for_map
from tests.browser.regions import region
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser


def opens_new_mission(visitor: Visitor, **how: Any) -> Page:
    page = visitor.signs_in("opal", **how)
    page.goto("/missions/new")
    wait_for_map(page)
    return page


def rows(page: Page) -> Locator:
    return page.get_by_role("list", name="Targets").get_by_role("listitem")


def searches(page: Page, text: str) -> None:
    page.keyboard.press("/")
    page.get_by_role("combobox", name="Find an asset or a line").fill(text)
    expect(page.get_by_role("listbox").get_by_role("option").first).to_have_attribute("aria-selected", "true")  # no longer what is in view


def adds_all(page: Page, text: str) -> tuple[int, int]:
    """How many assets a search has found, and how many targets these are: long lines come in parts."""
    searches(page, text)
    button = page.get_by_role("button", name=re.compile(r"Add all \d+"))
    found = int(re.findall(r"\d+", button.text_content() or "")[0])
    button.click()
    count = page.locator("#target-count")
    expect(count).to_have_text(re.compile(r"\d+"))
    return found, int(count.text_content() or "")


def longest_line(page: Page) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """The line with the most supports, and these in order."""
    lines = asks(page, "/assets?kind=line&flyable=true&limit=100")["features"]
    return max(((line, asks(page, f"/assets/{line['id']}/supports")["supports"]) for line in lines), key=lambda found: len(found[1]))


@pytest.mark.long
def test_a_lasso_takes_the_towers_and_bridges_inside_it(visitor: Visitor) -> None:
    page = opens_new_mission(visitor)
    tower = find_pickable(page).tower
    place = look_at(page, tower["geometry"]["coordinates"], 15)
    page.keyboard.press("o")
    expect(page.get_by_role("radio", name="Lasso")).to_be_checked()
    expect(page.get_by_text("Draw a line round towers and bridges.")).to_be_visible()
    page.mouse.move(place["x"], place["y"] - 60)
    page.mouse.down()
    for east, south in ((60, 0), (0, 60), (-60, 0), (0, -60)):
        page.mouse.move(place["x"] + east, place["y"] + south, steps=4)
    page.mouse.up()
    caught = page.get_by_role("dialog", name=re.compile(r"\d+ towers? on \d+ lines?|\d+ bridges?"))
    expect(caught).to_be_visible()
    expect(rows(page)).to_have_count(0)
    page.keyboard.press("Enter")
    expect(page.get_by_text(re.compile(r"\d+ targets? added from the area\."))).to_be_visible()
    expect(page.get_by_role("radio", name="Point")).to_be_checked()  # the tool ends with its act
    assert page.evaluate("document.activeElement !== document.body")  # the focus is not lost with the dialog
    assert tower["properties"]["label"] in targets(page)
    page.keyboard.press("Control+z")
    expect(rows(page)).to_have_count(0)

    page.keyboard.press("o")
    page.mouse.move(place["x"], place["y"] - 60)
    page.mouse.down()
    page.mouse.move(place["x"] + 60, place["y"], steps=4)
    page.mouse.move(place["x"], place["y"], steps=4)
    page.keyboard.press("Escape")
    page.mouse.up()  # over the tower: it is not picked either
    page.keyboard.press("v")
    expect(page.get_by_role("radio", name="Point")).to_be_checked()
    expect(rows(page)).to_have_count(0)


def test_a_stretch_between_two_towers_is_taken_tower_by_tower_or_flown_along(visitor: Visitor) -> None:
    page = opens_new_mission(visitor)
    _, supports = longest_line(page)
    first, last = supports[1], supports[4]

    def clicks_both() -> None:
        page.keyboard.press("t")
        for support in (first, last):
            place = look_at(page, support["centre"], 17)
            page.mouse.click(place["x"], place["y"])
            if support is first:
                expect(page.get_by_text(f"From {first['label']}. Now click the last tower.")).to_be_visible()

    clicks_both()
    page.get_by_role("button", name="All 4 towers").click()
    expect(rows(page)).to_have_count(4)
    assert targets(page) == [support["label"] for support in supports[1:5]]
    page.keyboard.press("Control+z")
    expect(rows(page)).to_have_count(0)
    clicks_both()
    page.get_by_role("button", name=re.compile("Fly along")).click()
    expect(rows(page)).to_have_count(1)
    expect(rows(page)).to_contain_text(re.compile(r"tower to tower, \d+\sm"))
    page.keyboard.press("Escape")
    expect(page.get_by_role("radio", name="Point")).to_be_checked()


def test_a_long_line_is_shared_by_uavs_in_parts_or_flown_whole_by_one(visitor: Visitor) -> None:
    page = opens_new_mission(visitor)
    line, _ = longest_line(page)
    parts = asks(page, f"/assets/{line['id']}/parts")["parts"]
    assert len(parts) > 2
    searches(page, line["properties"]["osm"])
    page.keyboard.press("Enter")
    group = page.get_by_role("button", name=re.compile(rf"km 0\.0–[\d.]+ ?{len(parts)} parts$"))
    expect(group).to_have_attribute("aria-expanded", "false")
    expect(page.locator("#target-count")).to_have_text(f"{len(parts)}")
    expect(page.get_by_text(f"is divided into {len(parts)} parts that UAVs share.")).to_be_visible()

    page.get_by_role("button", name="One UAV flies it whole").click()
    expect(rows(page)).to_have_count(1)
    expect(rows(page)).to_contain_text("whole line")
    page.keyboard.press("Control+z")
    expect(group).to_be_visible()
    page.keyboard.press("Control+Shift+z")
    page.get_by_role("button", name=re.compile("^Task, priority of ")).click()
    page.get_by_role("button", name="Share it among UAVs").click()
    expect(group).to_be_visible()
    task = page.get_by_role("button", name=re.compile(r"^Task, priority of .*km 0\.0"))
    task.click()
    page.get_by_label("Inspection speed").fill("6")
    page.keyboard.press("Enter")
    expect(task).to_have_accessible_name(re.compile(r"Fly-by, 6\sm/s$"))
    group.click()
    expect(rows(page)).to_have_count(len(parts))
    expect(page.locator("#target-list .task", has_text="6\xa0m/s")).to_have_count(len(parts))
    assert targets(page) == [part["label"] for part in parts]
    page.get_by_role("button", name=re.compile("^Task, priority of ")).first.click()
    page.get_by_role("button", name="One UAV flies it whole").click()
    expect(rows(page)).to_have_count(1)
    assert targets(page) == [line["properties"]["label"]]


@pytest.mark.long
def test_every_bridge_of_a_railway_is_picked_from_its_row(visitor: Visitor) -> None:
    page = opens_new_mission(visitor)
    railways = asks(page, "/assets?kind=railway&flyable=true&limit=200")["features"]
    railway, bridges = next(
        (railway, found["bridges"])
        for railway in railways
        if railway["properties"]["ref"] or railway["properties"]["name"]
        for found in [asks(page, f"/assets/{railway['id']}/bridges?sections=all")]
        if found["bridges"] and found["sections"] > 1
    )
    searches(page, railway["properties"]["osm"])
    page.get_by_role("listbox").get_by_role("option").filter(has_text="section").click()
    expect(rows(page)).to_have_count(1)
    if page.locator("#target-list .group-head").count():
        page.locator("#target-list .group-head").click()
    parts = len(targets(page))
    page.get_by_role("button", name=re.compile("^Task, priority of ")).first.click()
    page.get_by_role("button", name="Add every bridge of it").click()
    expect(page.locator("#target-count")).to_have_text(f"{parts + len(bridges)}")
    assert targets(page)[parts:] == [bridge["label"] for bridge in bridges]


def test_a_search_takes_all_that_match_and_is_filtered(visitor: Visitor) -> None:
    page = opens_new_mission(visitor)
    count = asks(page, f"/assets?text={region.voltage_kv}&flyable=true&total=true&limit=1")["total"]
    found, targets_added = adds_all(page, str(region.voltage_kv))
    assert targets_added >= found == count > 1
    page.get_by_role("button", name="Undo", exact=True).first.click()
    expect(rows(page)).to_have_count(0)

    tower = find_pickable(page).tower
    look_at(page, tower["geometry"]["coordinates"], 15)
    page.keyboard.press("/")
    page.get_by_role("button", name="Towers", exact=True).click()
    expect(page.get_by_role("button", name="Towers", exact=True)).to_have_attribute("aria-pressed", "true")
    expect(page.locator("#found-head")).to_have_text(re.compile(r"\d+ assets? in view"))
    icons = page.get_by_role("listbox").get_by_role("option").locator(".icon use")
    kinds = icons.evaluate_all("uses => uses.map(use => use.getAttribute('href').split('#')[1])")
    assert set(kinds) == {"tower"}
    page.get_by_role("combobox", name="Find an asset or a line").fill("no such thing")
    expect(page.get_by_text("No asset matches “no such thing” with these filters.")).to_be_visible()


@pytest.mark.long
def test_enter_waits_for_what_has_been_typed(visitor: Visitor) -> None:
    page = opens_new_mission(visitor)
    line, _ = longest_line(page)
    page.keyboard.press("/")
    expect(page.get_by_role("listbox").get_by_role("option").first).to_be_visible()  # what is in view
    page.keyboard.type(line["properties"]["osm"])
    page.keyboard.press("Enter")
    expect(rows(page)).to_have_count(1)
    assert targets(page)[0].startswith(line["properties"]["label"])


def test_a_pasted_list_says_what_is_found_what_is_unclear_and_what_is_unknown(
    visitor: Visitor, picture: Callable[[Page, str], None]
) -> None:
    page = opens_new_mission(visitor)
    towers = asks(page, "/assets?kind=tower&flyable=true&limit=3")["features"]
    name, shared = shared_name(page)
    page.keyboard.press("i")
    dialog = page.get_by_role("dialog", name="Paste a list")
    words = [feature["properties"]["osm"] for feature in towers]
    dialog.get_by_label("References, names or OSM ids").fill("\n".join([*words, name, "nowhere 7"]))
    dialog.get_by_role("button", name="Look them up").click()
    expect(page.get_by_role("heading", name="3 found, 1 means several things, 1 not found.")).to_be_focused()
    dialog = page.get_by_role("dialog")
    expect(dialog.get_by_role("region", name="Not known")).to_contain_text("nowhere 7")
    expect(dialog.get_by_role("button", name="Add 3 targets")).to_be_enabled()
    dialog.get_by_label(name).select_option(index=2)
    picture(page, "select-pasted-list")
    dialog.get_by_role("button", name="Add 4 targets").click()
    expect(rows(page)).to_have_count(4)
    assert targets(page)[:3] == [feature["properties"]["label"] for feature in towers]
    assert targets(page)[3] in shared
    page.keyboard.press("Control+z")
    expect(rows(page)).to_have_count(0)


def shared_name(page: Page) -> tuple[str, list[str]]:
    """A name that several railways have, and what these are called."""
    features = asks(page, "/assets?kind=railway&flyable=true&limit=1000")["features"]
    names = [feature["properties"]["name"] for feature in features if feature["properties"]["name"]]
    name = next(name for name in names if names.count(name) > 1 and not re.search(r"[,;]", name))
    return name, [feature["properties"]["label"] for feature in features if feature["properties"]["name"] == name]


def tasks(page: Page) -> list[str]:
    buttons = page.get_by_role("button", name=re.compile("^Task, priority of "))
    return [str(button.get_attribute("title")).removesuffix(". Change task, priority") for button in buttons.all()]


@pytest.mark.long
def test_a_kml_is_looked_up_and_its_unknown_points_are_added_by_their_coordinates(
    visitor: Visitor, picture: Callable[[Page, str], None]
) -> None:
    page = opens_new_mission(visitor)
    tower = asks(page, "/assets?kind=tower&flyable=true&limit=1")["features"][0]
    west, south = region.empty
    places = [(tower["properties"]["osm"], "0,0"), ("Mast of nobody", f"{west},{south},12"), ("", "")]
    marks = "".join(
        f"<Placemark><name>{name}</name>{f'<Point><coordinates>{at}</coordinates></Point>' if at else ''}</Placemark>"
        for name, at in places
    )
    content = f'<kml xmlns="http://www.opengis.net/kml/2.2"><Document>{marks}</Document></kml>'
    page.keyboard.press("i")
    file = {"name": "masts.kml", "mimeType": "application/vnd.google-earth.kml+xml", "buffer": content.encode()}
    page.get_by_label("Take the list from a file").set_input_files(file)
    page.get_by_role("button", name="Look them up").click()
    expect(page.get_by_role("heading", name="1 found, 1 by coordinates.")).to_be_focused()
    dialog = page.get_by_role("dialog")
    expect(dialog.get_by_role("region", name="By coordinates")).to_contain_text("Mast of nobody")
    expect(dialog).to_contain_text("1 shape without a name is left out")
    picture(page, "select-kml")
    assert faults(page) == []
    dialog.get_by_role("checkbox", name="Add them as places").uncheck()
    expect(dialog.get_by_role("button", name="Add 1 target")).to_be_enabled()
    dialog.get_by_role("checkbox", name="Add them as places").check()
    dialog.get_by_role("button", name="Add 2 targets").click()
    expect(rows(page)).to_have_count(2)
    assert targets(page) == [tower["properties"]["label"], f"{south:.5f}, {west:.5f}"]


def test_tasks_are_set_for_one_and_for_several_and_undone_step_by_step(visitor: Visitor, picture: Callable[[Page, str], None]) -> None:
    page = opens_new_mission(visitor)
    _, supports = longest_line(page)
    page.keyboard.press("i")
    page.get_by_label("References, names or OSM ids").fill("\n".join(osm_of(page, support["id"]) for support in supports[:4]))
    page.get_by_role("button", name="Look them up").click()
    page.get_by_role("button", name="Add 4 targets").click()
    usual = "Take photos, 10\u00a0s"
    expect(rows(page)).to_have_count(4)
    assert tasks(page) == [usual] * 4

    page.get_by_role("button", name=re.compile("^Task, priority of ")).first.click()
    page.get_by_role("button", name="Hover", exact=True).click()
    assert tasks(page) == ["Hover, 30\u00a0s", usual, usual, usual]
    page.locator("#target-list .what").nth(1).click()
    page.locator("#target-list .what").nth(3).click(modifiers=["Shift"])
    expect(page.get_by_text("3 chosen")).to_be_visible()
    page.get_by_role("button", name="Task, priority, UAV", exact=True).click()
    page.get_by_label("Hover time").fill("45")
    page.keyboard.press("Enter")
    assert tasks(page) == ["Hover, 30\u00a0s", *["Take photos, 45\u00a0s"] * 3]

    page.wait_for_function(
        """() => Object.keys(localStorage).some((key) => key.startsWith('spanwise.draft.')
            && JSON.parse(localStorage.getItem(key)).selection.targets.filter(({ task }) => task).length === 4)"""
    )
    page.reload()
    wait_for_map(page)
    assert tasks(page) == ["Hover, 30\u00a0s", *["Take photos, 45\u00a0s"] * 3]
    page.get_by_role("button", name=re.compile("^Task, priority of ")).first.click()
    picture(page, "select-task")
    page.get_by_role("button", name="Take photos", exact=True).click()
    assert tasks(page)[0] == usual
    page.keyboard.press("Control+z")
    assert tasks(page)[0] == "Hover, 30\u00a0s"
    page.keyboard.press("Control+Shift+Z")
    assert tasks(page)[0] == usual


def osm_of(page: Page, asset: int) -> str:
    return str(asks(page, f"/assets/{asset}")["properties"]["osm"])


@pytest.mark.long
def test_several_targets_are_chosen_by_keyboard_and_removed_and_everything_is_undone(visitor: Visitor) -> None:
    page = opens_new_mission(visitor)
    _found, count = adds_all(page, str(region.voltage_kv))
    shown = page.locator("#target-count")
    page.get_by_role("button", name="Choose", exact=True).focus()
    page.keyboard.press("Enter")
    expect(page.get_by_role("checkbox", name=re.compile("^Choose ")).first).to_be_focused()
    page.keyboard.press("Space")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Space")
    expect(page.get_by_text("2 chosen")).to_be_visible()
    page.keyboard.press("Delete")
    expect(shown).to_have_text(f"{count - 2}")
    page.get_by_role("button", name="All", exact=True).click()
    expect(page.get_by_text(f"{count - 2} chosen")).to_be_visible()
    page.get_by_role("group", name="Chosen targets").get_by_role("button", name="Remove").click()
    expect(page.get_by_text("Nothing picked yet", exact=True)).to_be_visible()
    undo = page.get_by_role("button", name="Undo", exact=True).first
    undo.click()
    expect(shown).to_have_text(f"{count - 2}")
    undo.click()
    expect(shown).to_have_text(f"{count}")
    undo.click()
    expect(rows(page)).to_have_count(0)
    expect(undo).to_be_disabled()


@pytest.mark.long
def test_the_targets_of_a_folded_line_are_passed_and_removed_at_once_by_keyboard(visitor: Visitor) -> None:
    page = opens_new_mission(visitor)
    _line, supports = longest_line(page)
    page.keyboard.press("i")
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("References, names or OSM ids").fill("\n".join(osm_of(page, support["id"]) for support in supports[:16]))
    dialog.get_by_role("button", name="Look them up").click()
    dialog.get_by_role("button", name="Add 16 targets").click()
    head = page.locator("#target-list .group-head").first
    size = int((head.locator("small").text_content() or "").split()[0])
    head.focus()
    page.keyboard.press("Enter")
    expect(head).to_have_attribute("aria-expanded", "false")
    expect(rows(page)).to_have_count(16 - size + 1)
    page.keyboard.press("ArrowDown")
    if size < 16:
        expect(head).not_to_be_focused()
        page.keyboard.press("ArrowUp")
    expect(head).to_be_focused()
    page.keyboard.press("Delete")
    expect(page.get_by_text(f"{size} targets removed.")).to_be_visible()
    expect(rows(page)).to_have_count(16 - size)


@pytest.mark.long
def test_a_selection_is_kept_loaded_renamed_deleted_and_brought_back(visitor: Visitor) -> None:
    page = opens_new_mission(visitor)
    _found, count = adds_all(page, str(region.voltage_kv))
    page.get_by_role("button", name="Saved selections").click()
    dialog = page.get_by_role("dialog", name="Saved selections")
    dialog.get_by_label(f"Keep the {count} picked targets as").fill("Test belt")
    page.keyboard.press("Enter")
    expect(dialog.get_by_role("status")).to_have_text("“Test belt” is kept.")
    row = dialog.get_by_role("listitem").filter(has_text="Test belt")
    expect(row).to_contain_text(f"{count} targets · opal")
    page.keyboard.press("Escape")

    other = visitor.signs_in("rory")
    other.goto("/missions/new")
    wait_for_map(other)
    other.get_by_role("button", name="Saved selections").click()
    other.get_by_role("button", name="Add Test belt").click()
    expect(other.locator("#target-count")).to_have_text(f"{count}")
    assert targets(other) == targets(page)

    page.get_by_role("button", name="Saved selections").click()
    dialog.get_by_role("button", name="Rename: Test belt").click()
    dialog.get_by_label("New name of Test belt").fill("Belt of all")
    page.keyboard.press("Enter")
    dialog.get_by_role("button", name="Delete: Belt of all").click()
    expect(dialog.get_by_role("status")).to_contain_text("“Belt of all” is deleted.")
    expect(dialog.get_by_role("button", name="Add Belt of all")).to_have_count(0)
    dialog.get_by_role("button", name="Undo").click()
    expect(dialog.get_by_role("button", name="Add Belt of all")).to_be_visible()
    dialog.get_by_role("button", name="Delete: Belt of all").click()
    expect(dialog.get_by_role("button", name="Add Belt of all")).to_have_count(0)
