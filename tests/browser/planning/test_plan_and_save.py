"""The whole way: pick on the map, plan, save, find again."""

import re
from collections.abc import Callable
from uuid import uuid4

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import (
    adds_uav,
    asks,
    clicks_at,
    find_pickable,
    look_at,
    second_facts,
    stores_mission,
    targets,
    wait_for_map,
)
from tests.browser.planning.test_planning import sends
from tests.browser.regions import region

pytestmark = pytest.mark.browser


def test_two_uavs_and_four_targets_are_picked_planned_saved_and_reopened(visitor: Visitor, picture: Callable[[Page, str], None]) -> None:
    page = visitor.signs_in("opal", "/")
    page.keyboard.press("n")
    page.wait_for_url(re.compile("/missions/new"))
    wait_for_map(page)

    base = sends(page, "bases", {"name": f"Yard {uuid4().hex[:8]}", "position": region.west})
    adds_uav(page, "Heron", region.west, range_km=80, base=base["name"])
    assert [uav["properties"]["base"] for uav in asks(page, "/uavs?text=Heron")["features"]] == [base["id"]], (
        "one of the fleet's, no text of its own"
    )
    adds_uav(page, "Kite", region.east, range_km=80)
    things = find_pickable(page)
    picked_so_far = page.locator("#target-list .target")
    clicks_at(page, things.tower["geometry"]["coordinates"])
    expect(picked_so_far).to_have_count(1)
    clicks_at(page, things.bridge["properties"]["centre"])
    expect(picked_so_far).to_have_count(2)
    clicks_at(page, things.railway_point)
    expect(picked_so_far).to_have_count(3)
    page.keyboard.press("w")
    clicks_at(page, things.line_point)
    page.get_by_role("button", name="One UAV flies it whole").click()
    expect(page.get_by_text(re.compile("One UAV flies .* from end to end"))).to_be_visible()
    page.keyboard.press("v")
    expect(picked_so_far).to_have_count(4)
    kinds = page.locator("#target-list .target > .icon use").evaluate_all("uses => uses.map(use => use.getAttribute('href').split('#')[1])")
    assert kinds == ["tower", "bridge", "railway", "line"]
    picked = targets(page)
    assert picked[0] == things.tower["properties"]["label"]
    assert picked[1] == things.bridge["properties"]["label"]
    assert picked[3] == things.line["properties"]["label"]
    facts_of_targets = second_facts(page)
    assert re.fullmatch(region.tower_label, picked[0])
    assert facts_of_targets[picked[0]] == things.tower["properties"]["detail"] != ""
    assert facts_of_targets[picked[1]] == things.bridge["properties"]["detail"] != ""
    assert facts_of_targets[picked[3]].startswith("whole line")

    page.get_by_role("textbox", name="Name of the mission").fill("South belt, autumn")
    page.keyboard.press("Tab")
    page.get_by_role("button", name="Plan P").click()
    routes = page.get_by_role("list", name="Routes")
    expect(routes.get_by_role("listitem")).to_have_count(2)
    expect(page.locator("#plan-sentence")).to_have_text(re.compile(r"All back in \d+\smin\."))
    expect(page.locator("#plan-facts")).to_have_text(re.compile(r"all 4 targets · [12] UAVs? · \d+\.\d\skm"))
    numbers = page.locator("#target-list .pill").all_text_contents()
    assert len(numbers) == 4 and all(re.fullmatch(r"[AB]\d", number) for number in numbers)
    facts = page.locator("#plan-facts").text_content()

    expect(page.get_by_text("“South belt, autumn” is saved. From now on it saves itself.")).to_be_visible()
    expect(page).to_have_url(re.compile(r"/missions/[0-9a-f-]{36}"))
    expect(page.locator("#plan-facts")).to_have_text(facts or "")  # what was shown is what is stored
    expect(page.locator("#save-state")).to_have_text(re.compile(r"^Saved \d\d:\d\d$"))
    page.locator("#toasts .toast").wait_for(state="detached")
    page.keyboard.press("f")
    wait_for_map(page)
    picture(page, "plan-light")

    page.get_by_role("link", name="Missions", exact=True).first.click()
    row = page.get_by_role("row").filter(has_text="South belt, autumn").filter(has_text="opal")
    expect(row).to_contain_text("Planned")
    expect(row).to_contain_text("4 targets")
    picture(page, "missions-light")
    row.get_by_role("link", name="South belt, autumn").click()
    wait_for_map(page)
    expect(page.locator("#plan-facts")).to_have_text(facts or "")
    assert sorted(targets(page)) == sorted(picked)
    assert second_facts(page) == facts_of_targets
    expect(page.locator("#save-state")).to_have_text(re.compile(r"^Saved \d\d:\d\d$"))
    address = page.url.split("#")[0]

    page.get_by_role("button", name="Theme: as the system").click()
    with page.expect_response(lambda answer: answer.url.endswith("/account") and "dark" in (answer.request.post_data or "")):
        page.get_by_role("button", name="Theme: light").click()
    expect(page.locator("html")).to_have_attribute("data-theme", "dark")
    page.goto(address)
    wait_for_map(page)
    expect(page.locator("html")).to_have_attribute("data-theme", "dark")
    picture(page, "plan-dark")
    page.goto("/")
    expect(page.get_by_role("row").filter(has_text="South belt, autumn")).to_be_visible()
    picture(page, "missions-dark")
    with page.expect_response(lambda answer: answer.url.endswith("/account") and "system" in (answer.request.post_data or "")):
        page.get_by_role("button", name="Theme: dark").click()

    row = page.get_by_role("row").filter(has_text="South belt, autumn").filter(has_text="opal")
    row.get_by_role("button", name="More for South belt, autumn").click()
    page.get_by_role("button", name="Delete", exact=True).click()
    expect(page.get_by_text("“South belt, autumn” is deleted.")).to_be_visible()
    expect(page.get_by_role("row").filter(has_text="South belt, autumn")).to_have_count(0)
    page.get_by_role("button", name="Undo", exact=True).click()
    expect(page.get_by_role("row").filter(has_text="South belt, autumn")).to_be_visible()


def test_the_mission_fits_a_phone(visitor: Visitor, picture: Callable[[Page, str], None]) -> None:
    stores_mission(visitor.signs_in("opal"), "Towers on a phone")
    for theme in ("light", "dark"):
        page = visitor.signs_in("opal", "/", size=(390, 844), theme=theme, touch=True)
        page.get_by_role("link", name="Towers on a phone").click()
        wait_for_map(page)
        expect(page.locator("#plan-sentence")).to_contain_text("All back in")
        assert page.evaluate("document.documentElement.scrollWidth") == 390
        picture(page, f"plan-phone-{theme}")
        before = page.locator("#map").bounding_box()
        page.get_by_role("button", name="Panel height").click()
        page.get_by_role("button", name="Panel height: full").click()
        page.get_by_role("button", name="Panel height: low").wait_for()
        after = page.locator("#map").bounding_box()
        assert before and after and after["height"] > before["height"] * 1.5


def test_what_is_picked_can_be_undone_and_survives_a_reload(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    page.goto("/missions/new")
    wait_for_map(page)
    page.keyboard.press("/")
    find = page.get_by_role("combobox", name="Find an asset or a line")
    expect(find).to_be_focused()
    expect(page.get_by_role("listbox").get_by_role("option").first).to_be_visible()  # empty: what is in view
    find.fill("bridge")
    expect(page.get_by_role("listbox").get_by_role("option").first).to_have_attribute("aria-selected", "true")
    page.keyboard.press("Enter")
    expect(page.locator("#target-list .target")).to_have_count(1)
    find.fill("bridge")
    page.get_by_role("listbox").get_by_role("option").nth(1).click()
    expect(page.locator("#target-list .target")).to_have_count(2)
    page.locator("#map canvas").focus()

    page.keyboard.press("Control+z")
    expect(page.locator("#target-list .target")).to_have_count(1)
    page.keyboard.press("Control+Shift+Z")
    expect(page.locator("#target-list .target")).to_have_count(2)
    page.locator("#target-list .what").first.focus()
    page.keyboard.press("Delete")
    expect(page.locator("#target-list .target")).to_have_count(1)
    page.get_by_role("status").get_by_role("button", name="Undo").click()
    expect(page.locator("#target-list .target")).to_have_count(2)

    page.wait_for_function(
        """() => Object.keys(localStorage).some((key) => /^spanwise[.]draft[.][0-9]+[.]new$/.test(key)
            && JSON.parse(localStorage.getItem(key)).selection.targets.length === 2)"""
    )
    page.reload()
    expect(page.get_by_text("Your unsaved mission is back.")).to_be_visible()
    expect(page.locator("#target-list .target")).to_have_count(2)
    page.get_by_role("button", name="Start empty").click()
    expect(page.get_by_text("Nothing picked yet", exact=True)).to_be_visible()


@pytest.mark.long
def test_shift_drag_takes_the_towers_in_a_box(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    page.goto("/missions/new")
    wait_for_map(page)
    tower = find_pickable(page).tower["geometry"]["coordinates"]
    place = look_at(page, tower, 15)
    page.keyboard.down("Shift")
    page.mouse.move(place["x"] - 40, place["y"] - 40)
    page.mouse.down()
    page.mouse.move(place["x"] + 40, place["y"] + 40, steps=4)
    page.mouse.up()
    page.keyboard.up("Shift")
    page.get_by_role("dialog").get_by_role("button", name=re.compile(r"Add \d+ target")).click()
    expect(page.get_by_text(re.compile(r"\d+ targets? added from the area\."))).to_be_visible()
    assert page.locator("#target-list .target").count() >= 1


@pytest.mark.long
def test_keys_are_shown_and_fold_the_panels(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    page.goto("/missions/new")
    wait_for_map(page)
    page.keyboard.press("?")
    expect(page.get_by_role("dialog", name="Keyboard")).to_contain_text("Pick whole lines")
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)
    before = page.locator("#map").bounding_box()
    page.keyboard.press("[")
    expect(page.locator("#mission-name")).to_be_hidden()
    after = page.locator("#map").bounding_box()
    assert before and after and after["width"] == before["width"] + 376
    page.keyboard.press("[")
    page.keyboard.press("b")
    expect(page.get_by_role("radio", name="Box")).to_be_checked()
    page.keyboard.press("Escape")
    expect(page.get_by_role("radio", name="Point")).to_be_checked()
