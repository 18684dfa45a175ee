"""Wishes of whoever plans: who flies what and where in the order, how urgent, what that costs; and large plans while they are made."""

import re
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, wait_for_map
from tests.browser.planning.test_planning import opens_mission, sends
from tests.browser.regions import region
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser

Picture = Callable[[Page, str], None]
# Proven where its routes lose nothing to turns; else the gap, which contains them.
IS_GOOD = re.compile(r"Proven soonest\.|Within [\d.]+\s% of the best possible\.")
PHONE: dict[str, Any] = {"theme": "dark", "size": (390, 844), "touch": True}


def route(page: Page, uav: str) -> Locator:
    return page.get_by_role("list", name="Routes").get_by_role("listitem").filter(has_text=uav)


def strip(page: Page, uav: str) -> Locator:
    return route(page, uav).get_by_role("img").first


def menu_of(page: Page, target: str) -> Locator:
    page.get_by_role("button", name=re.compile(rf"^Task, priority of {re.escape(target)}: ")).first.focus()
    page.keyboard.press("Enter")
    return page.get_by_role("group", name=f"Task, priority: {target}", exact=True)


def gives(page: Page, target: str, uav: str) -> None:
    """By the chip of its row, with the keyboard."""
    page.get_by_role("button", name=f"UAV: any, {target}", exact=True).focus()
    page.keyboard.press("Enter")
    page.get_by_role("group", name=f"UAV of {target}", exact=True).get_by_role("button", name=uav).focus()
    page.keyboard.press("Enter")


def locks(page: Page) -> Locator:
    """The buttons of locked targets."""
    return page.get_by_role("list", name="Targets", exact=True).get_by_role("button", name="unlock", pressed=True)


def names_in_order(page: Page) -> list[str]:
    return page.get_by_role("list", name="Targets", exact=True).locator(".what span").all_text_contents()


def places_of_drag(page: Page, number: str, uav: str, to: str, at_x: float) -> tuple[dict[str, float], dict[str, float]]:
    """The middle of a pill, and a place on another UAV's strip so many px from its begin."""
    pill = strip(page, uav).get_by_text(number, exact=True)
    pill.scroll_into_view_if_needed()
    box, place = pill.bounding_box(), strip(page, to).bounding_box()
    assert box and place
    return {"x": box["x"] + box["width"] / 2, "y": box["y"] + box["height"] / 2}, {"x": place["x"] + at_x, "y": place["y"] + 18}


def drags_a_pill(page: Page, number: str, uav: str, *, to: str, at_x: float) -> None:
    begin, end = places_of_drag(page, number, uav, to, at_x)
    page.mouse.move(**begin)
    page.mouse.down()
    page.mouse.move(**end, steps=4)
    page.mouse.up()


def draws_a_pill_by_finger(page: Page, number: str, uav: str, *, to: str, at_x: float) -> None:
    begin, end = places_of_drag(page, number, uav, to, at_x)
    touch = page.context.new_cdp_session(page)
    touch.send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [begin]})
    for share in (0.3, 0.7, 1):
        at = {axis: begin[axis] + (end[axis] - begin[axis]) * share for axis in begin}
        touch.send("Input.dispatchTouchEvent", {"type": "touchMove", "touchPoints": [at]})
    touch.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


@pytest.mark.long
def test_a_pill_dragged_to_another_uav_is_locked_there_and_says_what_that_costs(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "By hand")
    quality = page.locator("#plan-quality")
    expect(quality).to_contain_text(IS_GOOD)
    first = re.compile("flies .*: 1 (.+?), 2")
    expect(strip(page, "Kite")).to_have_attribute("aria-label", first)
    given = first.search(strip(page, "Kite").get_attribute("aria-label") or "")
    assert given
    drags_a_pill(page, "1", "Kite", to="Heron", at_x=8)
    expect(page.get_by_text("is locked as target 1 of Heron.")).to_be_visible()
    expect(strip(page, "Heron")).to_have_attribute("aria-label", re.compile(f": 1 {given[1]} \\(locked\\), 2"))
    expect(page.get_by_text(re.compile("^Planned again: "))).to_be_visible()  # at once, as it is a small change
    expect(quality).to_contain_text("The change costs")
    page.keyboard.press("Control+z")
    expect(strip(page, "Heron")).not_to_have_attribute("aria-label", re.compile("locked"))
    page.keyboard.press("Control+Shift+z")

    expect(quality).to_contain_text(re.compile(r"The change costs \d+\smin more \(\+[\d.]+\s%\)\."))
    expect(quality).to_contain_text("with the locked targets.")
    expect(locks(page)).to_have_count(1)
    expect(locks(page)).to_have_accessible_name(re.compile("Locked as target 1 of Heron: unlock$"))
    expect(page.get_by_role("button", name=f"UAV: Heron, {given[1]}", exact=True)).to_be_visible()
    assert names_in_order(page)[0] == given[1]
    picture(page, "plan-wish-light")
    assert faults(page) == []
    expect(page.locator("#save-state")).to_contain_text("Saved")
    page.reload()
    wait_for_map(page)
    expect(quality).to_contain_text("The change costs")
    quality.get_by_role("button", name="Unlock all").click()
    expect(locks(page)).to_have_count(0)


def test_the_order_is_changed_and_locked_by_keyboard_alone(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "By keyboard")
    expect(page.locator("#plan-quality")).to_contain_text(IS_GOOD)
    first, second = names_in_order(page)[:2]
    menu = menu_of(page, first)
    menu.get_by_role("button", name="Later").focus()
    page.keyboard.press("Enter")
    expect(page.get_by_text(f"{first} is locked as target 2 of Heron.")).to_be_visible()
    assert names_in_order(page)[:2] == [second, first]
    rows = page.get_by_role("list", name="Targets", exact=True)
    rows.locator("button.what").filter(has=page.get_by_text(first, exact=True)).focus()
    page.keyboard.press("Alt+ArrowUp")
    assert names_in_order(page)[:2] == [first, second]
    lock = page.get_by_role("button", name=f"{first}: Locked as target 1 of Heron: unlock", exact=True)
    lock.focus()
    page.keyboard.press("Enter")
    expect(page.get_by_text(f"{first} is not locked any more.")).to_be_visible()
    expect(lock).to_have_count(0)
    gives(page, first, "Kite")
    expect(page.get_by_text("1 target is flown by Kite alone.")).to_be_visible()
    expect(page.get_by_text(re.compile("^Planned again: "))).to_be_visible()
    expect(strip(page, "Kite")).to_have_attribute("aria-label", re.compile(f"[,:] \\d+ {first}"))
    expect(page.get_by_role("button", name=f"UAV: Kite, {first}", exact=True)).to_be_focused()


@pytest.mark.long
def test_wishes_of_targets_and_uavs_are_saved_undone_and_seen_on_a_phone(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal", **PHONE)
    sends(page, "bases", {"name": "Wishing yard", "position": region.at(0, 0.02)})
    sends(page, "uavs", {"name": "Sensing", "position": region.at(0, -0.05), "sensor": "Corona camera"})
    opens_mission(page, "With wishes", targets=5)
    expect(page.locator("#plan-quality")).to_contain_text(IS_GOOD)
    page.get_by_role("button", name="Panel height").click()
    draws_a_pill_by_finger(page, "1", "Kite", to="Heron", at_x=300)
    expect(page.get_by_text(re.compile("is locked as target . of Heron"))).to_be_visible()
    expect(strip(page, "Heron")).to_have_attribute("aria-label", re.compile(r"\(locked\)\.$"))
    picture(page, "plan-wish-phone-dark")
    page.get_by_role("button", name="Unlock all").click()
    expect(locks(page)).to_have_count(0)
    first, second = names_in_order(page)[:2]
    rows = page.get_by_role("list", name="Targets", exact=True)
    menu_of(page, first).get_by_label("Priority").select_option("High")
    expect(rows.get_by_role("img", name="High priority")).to_have_count(1)
    gives(page, second, "Kite")
    menu_of(page, second)
    picture(page, "plan-wishes-phone")
    assert faults(page) == []
    page.keyboard.press("Escape")
    menu_of(page, second).get_by_label("Required sensor").select_option("Corona camera")
    expect(rows.get_by_role("listitem").filter(has_text="needs Corona camera").filter(has_text="UAV: Kite")).to_have_count(1)
    page.get_by_role("button", name="Undo").first.click()
    expect(rows).not_to_contain_text("needs Corona camera")

    page.get_by_role("switch", name="Return to start").click()
    page.get_by_role("button", name="Change Kite in this mission").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("At most this many targets").fill("2")
    dialog.get_by_label("End, where").select_option("Land at the nearest base")
    dialog.get_by_role("button", name="Change").click()
    page.mouse.move(0, 0)  # a notice under the pointer would stay
    kite = page.get_by_role("listitem").filter(has=page.get_by_role("button", name="Change Kite in this mission"))
    expect(kite).to_contain_text("at most 2 targets")
    expect(kite).to_contain_text("lands at the nearest base")
    page.get_by_role("button", name="Plan again").click()
    expect(route(page, "Kite")).to_contain_text(re.compile(r"\d\skm"))
    expect(strip(page, "Kite")).to_have_attribute("aria-label", re.compile("lands at the base "))
    expect(page.locator("#save-state")).to_contain_text("Saved")
    address = re.search("/missions/[0-9a-f-]+", page.url)
    assert address
    mission = asks(page, address[0])
    assert [target["priority"] for target in mission["targets"]].count("high") == 1
    assert mission["uavs"][1]["most_targets"] == 2
    page.reload()
    wait_for_map(page)
    expect(rows.get_by_role("img", name="High priority")).to_have_count(1)
    expect(rows).to_contain_text("UAV: Kite")


@pytest.mark.long
def test_a_large_plan_is_seen_while_it_is_made_comes_back_after_a_reload_and_can_be_stopped(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "In the making", targets=60)
    page.get_by_role("button", name="Plan P").click()
    so_far = page.get_by_text(re.compile(r"\d\smin so far, within [\d.]+\s% of the best possible \("))
    expect(so_far).to_be_visible()
    expect(page.get_by_label(re.compile(r"^Map, 60 targets, 2 routes so far"))).to_be_visible()
    picture(page, "plan-in-the-making")
    page.reload()
    expect(page.get_by_role("progressbar", name="Planning")).to_be_visible()
    expect(so_far).to_be_visible()
    page.get_by_role("button", name="Stop, keep the best").click()
    expect(page.get_by_text("Stopped. The best plan so far is kept.")).to_be_visible()
    expect(page.locator("#plan-quality")).to_contain_text(re.compile(r"Within [\d.]+\s% of the best possible\."))
    page.get_by_role("button", name="Plan again P").click()
    page.get_by_role("button", name="Cancel").click()
    expect(page.get_by_text("Planning stopped. Nothing was changed.")).to_be_visible()
    expect(page.locator("#plan-facts")).to_contain_text("60 targets")


@pytest.mark.long
def test_a_plan_of_what_was_picked_before_says_so_and_still_does_once_the_change_is_saved(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    opens_mission(page, "Changed on the way", targets=40)
    page.get_by_role("button", name="Plan P").click()
    stop = page.get_by_role("button", name="Stop, keep the best")
    expect(stop).to_be_visible()
    page.get_by_role("list", name="Targets", exact=True).get_by_role("button", name=re.compile("^Remove ")).first.click()
    expect(page.get_by_text("1 target removed.")).to_be_visible()
    stop.click()
    reported = page.get_by_text("The selection has changed since.")
    expect(reported).to_be_visible()
    expect(page.locator("#save-state")).to_contain_text(re.compile(r"^Saved \d"))
    expect(reported).to_be_visible()
    expect(page.locator("#plan-facts")).to_contain_text("for the selection before")
    expect(page.locator("#plan-quality")).to_be_hidden()
