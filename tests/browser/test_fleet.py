"""The page of the fleet: types, bases and UAVs are added, placed, edited by two people, retired, deleted and brought back."""

import re
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Visitor
from tests.browser.operator_map import asks, unlimited_type, wait_for_map
from tests.browser.regions import region
from tests.browser.test_accessibility import faults

pytestmark = pytest.mark.browser

Picture = Callable[[Page, str], None]
YARD = region.at(0.01, 0.01)


def fleet(page: Page, query: str = "") -> Page:
    page.goto(f"/uavs{query}")
    page.locator("html[data-loaded]").wait_for(state="attached")
    return page


def writes(page: Page, method: str, path: str, body: Any = None) -> Any:
    """What another operator, or the same one in another window, does meanwhile."""
    token = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "csrftoken")
    headers = {"X-CSRFToken": token, "If-Match": "*"}
    answer = page.request.fetch(f"/api/v1{path}", method=method, data=body or {}, headers=headers)
    assert answer.ok, f"{path}: {answer.status} {answer.text()}"
    return answer.json() if answer.status != 204 else None


def is_saved(page: Page, name: str) -> None:
    expect(page.get_by_text(f"{name} is saved.")).to_be_visible()
    expect(details(page).get_by_role("heading", name=name, exact=True)).to_be_visible()


def forgives(visitor: Visitor, *words: str) -> None:
    """What the browser says itself of an answer that the test provoked."""
    visitor.complaints[:] = [stated for stated in visitor.complaints if not any(message in stated for message in words)]


def tab(page: Page, name: str) -> None:
    page.get_by_role("radio", name=name).check()


def adds(page: Page, button: str, fields: dict[str, str]) -> None:
    page.get_by_role("button", name=button, exact=True).first.click()
    for label, value in fields.items():
        page.get_by_label(label, exact=True).fill(value)
    page.get_by_role("button", name="Save", exact=True).click()
    is_saved(page, fields["Name"])


def details(page: Page) -> Any:
    return page.get_by_role("region", name="Details")


def place_on_map(page: Page, position: list[float]) -> dict[str, float]:
    return page.evaluate(
        """(position) => {
            const map = document.getElementById("fleet-map");
            const box = map.getBoundingClientRect();
            const { x, y } = map.project(position);
            return { x: box.left + x, y: box.top + y };
        }""",
        position,
    )


REPORTS_A_CAMERA = """
from missions.models import Uav
from telemetry.models import UavLink
from django.utils import timezone
figures = dict(focal_length_mm=5.15, sensor_width_mm=5.2, sensor_height_mm=2.9, pixels_wide=2560, pixels_high=1440)
camera = dict(component=100, name="Siyi ZR10", **figures)
UavLink.objects.create(uav=Uav.objects.get(name="Siskin 1"), last_message_at=timezone.now(), cameras=[camera])
"""


def test_a_camera_that_a_uav_reports_is_added_to_its_type(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    kind = writes(page, "POST", "/uav-types", {"name": "Siskin", "range_unlimited": True})
    writes(page, "POST", "/uavs", {"name": "Siskin 1", "type": kind["id"], "position": YARD})
    visitor.site.does(REPORTS_A_CAMERA)
    fleet(page)
    page.get_by_role("link", name="Siskin 1").click()
    expect(details(page).get_by_text("Siyi ZR10, 2,560\u00a0×\u00a01,440, 5.2\u00a0mm")).to_be_visible()
    picture(page, "fleet-reported-camera")
    page.get_by_role("button", name="Add Siyi ZR10 to Siskin", exact=True).click()
    expect(page.get_by_role("heading", name="Edit Siskin")).to_be_visible()
    page.get_by_role("button", name="Save", exact=True).click()
    is_saved(page, "Siskin")
    (camera,) = asks(page, f"/uav-types/{kind['id']}")["cameras"]
    assert (camera["name"], camera["pixels_wide"], camera["focal_lengths_mm"]) == ("Siyi ZR10", 2560, [5.15])
    tab(page, "UAVs")
    page.get_by_role("link", name="Siskin 1").click()
    expect(details(page).get_by_text("Siyi ZR10, 2,560")).to_be_visible()
    expect(page.get_by_role("button", name="Add Siyi ZR10 to Siskin")).to_have_count(0)


def test_a_type_a_base_and_a_uav_are_added_and_the_uav_has_what_they_say(visitor: Visitor, picture: Picture) -> None:
    page = fleet(visitor.signs_in("opal"))
    tab(page, "Types")
    page.get_by_role("button", name="New type", exact=True).first.click()
    expect(page.get_by_label("Rotor area")).to_have_attribute("placeholder", "0.2059")  # an Iris's
    page.get_by_role("button", name="Cancel", exact=True).click()
    power = {"Battery": "400", "Mass": "6", "Rotor area": "0.6", "Power in a hover": "750"}
    adds(page, "New type", {"Name": "Harrier", "Range": "55", "Speed": "16", "Sensors": "RGB camera, Lidar"} | power)
    expect(details(page).get_by_text("0.600\u00a0m²")).to_be_visible()
    tab(page, "Bases")
    adds(page, "New base", {"Name": "East yard", "Latitude": f"{YARD[1]}", "Longitude": f"{YARD[0]}", "Note": "Gate code at the office"})
    tab(page, "UAVs")
    page.get_by_role("button", name="New UAV", exact=True).first.click()
    page.get_by_label("Name", exact=True).fill("Harrier 1")
    page.get_by_label("Type", exact=True).last.select_option("Harrier")
    page.get_by_label("Base", exact=True).last.select_option("East yard")
    expect(page.get_by_text("Blank: 55.0 km and 16 m/s of the type.")).to_be_visible()
    for field, of_type in (
        ("Battery (overrides the type)", "400"),
        ("Mass (overrides the type)", "6"),
        ("Reserve (overrides the type)", "20"),
        ("Maximum airspeed (overrides the type)", ""),
    ):
        expect(page.get_by_label(field)).to_have_attribute("placeholder", of_type)
    page.get_by_label("Battery (overrides the type)").fill("480")
    page.get_by_label("Reserve (overrides the type)").fill("120")
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.get_by_label("Reserve (overrides the type)")).to_be_focused()
    expect(page.get_by_label("Reserve (overrides the type)")).to_have_accessible_description(re.compile("At most 90."))
    page.get_by_label("Reserve (overrides the type)").fill("30")
    page.get_by_role("button", name="Save", exact=True).click()
    figures = ("480\u00a0Wh", "6\u00a0kg, as its type", "30\u00a0%")
    for words in ("55.0 km, as its type", "16 m/s, as its type", *figures, "RGB camera, Lidar", "No mission uses it yet."):
        expect(details(page).get_by_text(words)).to_be_visible()
    expect(page.get_by_role("row", name="Harrier 1").get_by_text("East yard")).to_be_visible()
    uav = asks(page, "/uavs?text=Harrier 1")["features"][0]
    assert uav["geometry"]["coordinates"] == YARD
    assert uav["properties"]["from_type"] == ["max_range_m", "cruise_speed_mps", "mass_kg"]
    assert (uav["properties"]["battery_wh"], uav["properties"]["reserve_percent"]) == (480.0, 30.0)
    picture(page, "uavs-light")

    page.goto("/missions/new")
    wait_for_map(page)
    page.get_by_role("button", name="Add a UAV").click()
    page.keyboard.press("Enter")  # the middle of the map
    dialog = page.get_by_role("dialog", name="Add a UAV")
    dialog.get_by_label("Name").fill("Harrier 2")
    dialog.get_by_label("Type").select_option("Harrier")
    expect(dialog.get_by_label("Battery", exact=True)).to_have_attribute("placeholder", "400")
    dialog.get_by_label("Mass at take-off").fill("7.5")
    assert faults(page) == []
    dialog.get_by_role("button", name="Add").click()
    expect(page.get_by_role("checkbox", name="Harrier 2")).to_be_checked()
    (added,) = asks(page, "/uavs?text=Harrier 2")["features"]
    assert {name: added["properties"][name] for name in ("battery_wh", "mass_kg", "type_name")} == {
        "battery_wh": 400.0, "mass_kg": 7.5, "type_name": "Harrier",
    }  # fmt: skip


@pytest.mark.long
def test_a_place_is_set_by_clicking_and_dragging_on_the_map(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    uav = writes(page, "POST", "/uavs", {"name": "Plover", "position": YARD, "type": unlimited_type(page)})["id"]
    fleet(page, f"?id={uav}")
    page.get_by_role("button", name="Edit").click()
    page.locator("#fleet-map[data-idle]").wait_for(state="attached")
    clicked = [YARD[0] + 0.01, YARD[1] + 0.004]
    page.mouse.click(**place_on_map(page, clicked))
    expect(page.get_by_label("Longitude")).not_to_have_value(f"{YARD[0]}")
    assert abs(float(page.get_by_label("Longitude").input_value()) - clicked[0]) < 0.001
    pin = page.get_by_role("button", name="Place, drag it").bounding_box()
    assert pin
    page.mouse.move(pin["x"] + pin["width"] / 2, pin["y"] + pin["height"] / 2)
    page.mouse.down()
    page.mouse.move(pin["x"] - 60, pin["y"] + 30, steps=5)
    page.mouse.up()
    typed = [float(page.get_by_label(name).input_value()) for name in ("Longitude", "Latitude")]
    assert typed[0] < clicked[0] - 0.002
    page.get_by_role("button", name="Save", exact=True).click()
    is_saved(page, "Plover")
    assert asks(page, f"/uavs/{uav}")["geometry"]["coordinates"] == pytest.approx(typed, abs=1e-6)


@pytest.mark.long
def test_a_uav_is_retired_with_a_way_back_and_is_not_offered_for_missions(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    uav = writes(page, "POST", "/uavs", {"name": "Dotterel", "position": YARD, "type": unlimited_type(page)})["id"]
    fleet(page, f"?id={uav}")
    details(page).get_by_role("button", name="Retire").click()
    expect(page.get_by_text("Dotterel is retired.")).to_be_visible()
    expect(details(page).get_by_text("It is not offered for new missions and does not connect.")).to_be_visible()
    page.goto("/missions/new")
    page.locator("html[data-loaded]").wait_for(state="attached")
    expect(page.get_by_text("Dotterel")).to_have_count(0)
    fleet(page)
    expect(page.get_by_role("link", name="Dotterel")).to_have_count(0)
    page.get_by_label("State", exact=True).select_option("retired")
    page.get_by_role("link", name="Dotterel").click()
    details(page).get_by_role("button", name="Bring back").click()
    expect(page.get_by_text("Dotterel is in service.")).to_be_visible()
    page.get_by_role("button", name="Undo").click()
    expect(details(page).get_by_role("button", name="Bring back")).to_be_visible()


@pytest.mark.long
def test_a_deleted_base_comes_back_and_one_in_use_stays(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    used = writes(page, "POST", "/bases", {"name": "Used yard", "position": YARD})["id"]
    spare = writes(page, "POST", "/bases", {"name": "Spare yard", "position": YARD})["id"]
    writes(page, "POST", "/uavs", {"name": "Whimbrel", "base": used, "type": unlimited_type(page)})
    fleet(page, f"?tab=bases&id={used}")
    details(page).get_by_role("button", name="Delete Used yard").click()
    expect(page.get_by_text("A UAV has this base. Give it another one first.")).to_be_visible()
    fleet(page, f"?tab=bases&id={spare}")
    details(page).get_by_role("button", name="Delete Spare yard").click()
    expect(page.get_by_role("link", name="Spare yard")).to_have_count(0)
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_role("link", name="Spare yard")).to_be_visible()
    assert asks(page, f"/bases/{spare}")["position"] == YARD
    forgives(visitor, "409")


def test_a_token_is_shown_once_replaced_and_revoked(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal", theme="dark")
    uav = writes(page, "POST", "/uavs", {"name": "Turnstone", "position": YARD, "type": unlimited_type(page)})["id"]
    fleet(page, f"?id={uav}")
    details(page).get_by_role("button", name="Create: Token of the HTTP link").click()
    secret = details(page).locator(".secret code")
    expect(secret).to_have_text(re.compile(r"^spu_[\w-]{43}$"))
    picture(page, "uav-token-dark")
    first = secret.text_content()
    details(page).get_by_role("button", name="Replace: Token of the HTTP link").click()
    expect(secret).not_to_have_text(first or "")
    page.reload()
    expect(details(page).get_by_text("not used yet")).to_be_visible()
    expect(secret).to_have_count(0)
    details(page).get_by_role("button", name="Revoke: Token of the HTTP link").click()
    details(page).get_by_role("button", name="Revoke it").click()
    expect(details(page).get_by_text("Not set.")).to_have_count(2)
    assert asks(page, f"/uavs/{uav}")["properties"]["credentials"] == []


@pytest.mark.long
def test_two_people_in_one_uav_see_each_others_changes(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    uav = writes(page, "POST", "/uavs", {"name": "Godwit", "position": YARD, "type": unlimited_type(page)})["id"]
    fleet(page, f"?id={uav}")
    details(page).get_by_role("button", name="Edit").click()
    page.get_by_label("Serial number").fill("SN-1")
    writes(visitor.signs_in("rory"), "PATCH", f"/uavs/{uav}", {"battery_percent": 40})
    page.get_by_role("button", name="Save", exact=True).click()
    expect(details(page).get_by_text("Changed by rory in the meantime.")).to_be_visible()
    expect(details(page).get_by_text("→ 40")).to_be_visible()
    page.get_by_role("button", name="Overwrite").click()
    is_saved(page, "Godwit")
    facts = asks(page, f"/uavs/{uav}")["properties"]
    assert (facts["serial_number"], facts["battery_percent"]) == ("SN-1", 40.0)
    forgives(visitor, "412")


@pytest.mark.long
def test_what_was_typed_stays_when_the_network_is_gone_and_comes_back_when_it_was_left(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    uav = writes(page, "POST", "/uavs", {"name": "Curlew", "position": YARD, "type": unlimited_type(page)})["id"]
    fleet(page, f"?id={uav}")
    details(page).get_by_role("button", name="Edit").click()
    page.get_by_label("Serial number").fill("SN-2")
    page.context.set_offline(True)
    page.get_by_role("button", name="Save", exact=True).click()
    expect(details(page).get_by_text("The server cannot be reached. What you typed stays here.")).to_be_visible()
    page.context.set_offline(False)
    page.get_by_role("button", name="Cancel", exact=True).click()
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_label("Serial number")).to_have_value("SN-2")
    page.get_by_role("button", name="Save", exact=True).click()
    is_saved(page, "Curlew")
    assert asks(page, f"/uavs/{uav}")["properties"]["serial_number"] == "SN-2"
    forgives(visitor, "ERR_INTERNET_DISCONNECTED", "map: ")  # a tile of the map may have been on its way


@pytest.mark.long
def test_a_uav_is_added_with_the_keyboard_alone(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    unlimited_type(page)
    fleet(page)
    page.keyboard.press("c")
    expect(page.get_by_label("Name", exact=True)).to_be_focused()
    page.keyboard.type("Lapwing")
    page.keyboard.press("Tab")
    page.keyboard.type("Unlimited")
    page.keyboard.press("Control+s")
    is_saved(page, "Lapwing")
    page.keyboard.press("e")
    expect(page.get_by_label("Name", exact=True)).to_be_focused()
    page.keyboard.press("Escape")
    expect(details(page).get_by_role("heading", name="Lapwing")).to_be_focused()
    page.keyboard.press("Escape")
    expect(page.get_by_role("link", name="Lapwing")).to_be_focused()
    page.keyboard.press("/")
    page.keyboard.type("no such bird")
    expect(page.get_by_text("Nothing matches “no such bird”")).to_be_visible()
    page.get_by_role("button", name="Clear the filter").press("Enter")
    expect(page.get_by_role("link", name="Lapwing")).to_be_visible()


@pytest.mark.long
@pytest.mark.parametrize(("theme", "size"), [("dark", (390, 844)), pytest.param("light", (1440, 900), marks=pytest.mark.long)])
def test_axe_finds_nothing_serious_in_details_and_forms(visitor: Visitor, theme: str, size: tuple[int, int], picture: Picture) -> None:
    page = visitor.signs_in("opal", theme=theme, size=size)
    uav = writes(page, "POST", "/uavs", {"name": f"Dunlin {theme}", "position": YARD, "type": unlimited_type(page)})["id"]
    fleet(page, f"?id={uav}")
    expect(details(page).get_by_text("No mission uses it yet.")).to_be_visible()
    assert faults(page) == []
    details(page).get_by_role("button", name="Create: MAVLink signing key").click()
    expect(details(page).locator(".secret code")).to_have_text(re.compile(r"^[0-9a-f]{64}$"))
    assert faults(page) == []
    details(page).get_by_role("button", name="Edit").click()
    expect(page.get_by_label("Name", exact=True)).to_be_focused()
    assert faults(page) == []
    picture(page, f"uav-edit-{theme}")


def test_a_viewer_looks_and_changes_nothing_on_a_phone(visitor: Visitor, picture: Picture) -> None:
    writes(visitor.signs_in("opal"), "POST", "/uavs", {"name": "Sanderling", "position": YARD, "battery_percent": 22})
    page = fleet(visitor.signs_in("vera", size=(390, 844), touch=True))
    picture(page, "uavs-phone")
    page.get_by_role("link", name="Sanderling").tap()
    expect(details(page).get_by_text(re.compile(r"^22\s%$")).first).to_be_visible()  # "22" alone is also a day of the month
    for name in ("Edit", "Retire", "Delete Sanderling", "Create: Token of the HTTP link", "New UAV"):
        expect(page.get_by_role("button", name=name)).to_have_count(0)
    page.get_by_role("button", name="All of them").tap()
    expect(page.get_by_role("link", name="Sanderling")).to_be_visible()


def test_it_is_said_which_simulated_airframe_flies_for_a_type(visitor: Visitor, picture: Picture) -> None:
    page = visitor.signs_in("opal")
    made = writes(page, "POST", "/uav-types", {"name": "Bench quad", "cruise_speed_mps": 10.0, "mass_kg": 1.5, "battery_wh": 60.0})["id"]
    fleet(page, f"?tab=types&id={made}")
    choice = details(page).get_by_role("combobox", name="Simulated airframe")
    expect(choice).to_have_value("")
    expect(details(page)).to_contain_text("Iris: 1.5")
    choice.select_option(label="Inspector")
    expect(page.get_by_text("In simulation Inspector flies for Bench quad.")).to_be_visible()
    expect(details(page)).to_contain_text("Inspector: ")
    assert asks(page, f"/uav-types/{made}/airframe") == {"airframe": "inspector", "flown": "inspector"}
    choice.scroll_into_view_if_needed()
    picture(page, "type-airframe")
    assert faults(page) == []
    viewer = fleet(visitor.signs_in("vera"), f"?tab=types&id={made}")
    expect(details(viewer).get_by_role("combobox", name="Simulated airframe")).to_be_disabled()
