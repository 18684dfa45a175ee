"""Which parts of a line were inspected and when last: of the line, in the register, and as tiles of the map."""

from datetime import datetime, timedelta
from typing import Any

import pytest
from django.contrib.gis.geos import LineString, Point
from django.test import Client
from django.utils import timezone

from inspection.models import Asset
from missions.models import InspectionTarget, Mission, MissionUav, TargetState, Uav
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import bridge, line, railway, tower
from tests.inspection.vector_tile import Feature, read_tile
from workspace.models import Organisation, User

pytestmark = pytest.mark.django_db
COURSE = tuple((10.0 + 0.004 * number, 56.0) for number in range(41))  # 40 spans of 249.5 m
SPAN_M = 249.5
NOW = timezone.now().replace(microsecond=0)
MONTH_AGO, YEAR_AGO = NOW - timedelta(days=30), NOW - timedelta(days=365)
TILE = (10, 540, 318)  # the tile with 10.0 to 10.16 degrees east, 56 north


@pytest.fixture
def user() -> User:
    return a_user()


@pytest.fixture
def client(user: User) -> Client:
    return client_of(user)


def inspect(
    user: User,
    asset: Asset,
    spans: tuple[int, int] | None = None,
    at: datetime = NOW,
    *,
    simulated: bool = False,
    state: TargetState = TargetState.COMPLETE,
    position: Point | None = None,
) -> Mission:
    """A mission that inspected an asset, or the spans of a line from one number to another."""
    mission = Mission.objects.create(organisation=user.organisation, author=user, name=f"Flight of {at:%F}")
    place = Point(10.0, 56.0, srid=4326)
    uav = Uav.objects.create(organisation=user.organisation, name=f"Tern {mission.pk}", is_simulated=simulated, location=place)
    MissionUav.objects.create(mission=mission, sequence=0, uav=uav, name=uav.name, start=place, cruise_speed_mps=10.0)
    stretch = LineString(*(COURSE[number] for number in spans), srid=4326) if spans else None
    facts = {"asset": asset, "label": "L1", "stretch": stretch, "position": position, "state": state, "state_at": at}
    InspectionTarget.objects.create(mission=mission, sequence=0, **facts)
    return mission


def parts_of(client: Client, asset: Asset) -> dict[str, Any]:
    answer = client.get(f"/api/v1/assets/{asset.pk}/inspected-parts")
    assert answer.status_code == 200, answer.content
    return dict(answer.json())


def spans_of(client: Client, asset: Asset) -> list[tuple[int, int, str | None]]:
    """From and to by the number of spans, and the mission."""
    parts = parts_of(client, asset)["parts"]
    return [(round(part["from_m"] / SPAN_M), round(part["to_m"] / SPAN_M), part["mission"] and part["mission"]["name"]) for part in parts]


def test_a_line_that_nobody_inspected_is_one_part_without_a_time(client: Client) -> None:
    told = parts_of(client, line(*COURSE))
    assert told["inspected_m"] == 0.0
    [part] = told["parts"]
    assert part == {
        "from_m": 0.0,
        "to_m": told["length_m"],
        "stretch": [[10.0, 56.0], [10.16, 56.0]],
        "can_be_target": True,
        "inspected_at": None,
        "mission": None,
    }


def test_the_newest_inspection_of_each_part_counts_whichever_way_it_was_flown(user: User, client: Client) -> None:
    of_line = line(*COURSE)
    old, new = inspect(user, of_line, (4, 20), YEAR_AGO), inspect(user, of_line, (24, 12), MONTH_AGO)
    inspect(user, of_line, (14, 16), YEAR_AGO - timedelta(days=1))
    assert spans_of(client, of_line) == [(0, 4, None), (4, 12, old.name), (12, 24, new.name), (24, 40, None)]
    told = parts_of(client, of_line)
    assert told["inspected_m"] == pytest.approx(20 * SPAN_M, rel=1e-3)
    assert datetime.fromisoformat(told["parts"][2]["inspected_at"]) == MONTH_AGO
    assert told["parts"][1]["stretch"] == [pytest.approx(COURSE[4]), pytest.approx(COURSE[12])]


def test_what_is_left_can_be_asked_for_in_parts_and_picked(user: User, client: Client) -> None:
    of_line = line(*COURSE)
    inspect(user, of_line, (0, 30))
    [_done, left] = parts_of(client, of_line)["parts"]
    ends = ",".join(str(degrees) for position in left["stretch"] for degrees in position)
    rest = client.get(f"/api/v1/assets/{of_line.pk}/parts?ends={ends}").json()
    assert rest["length_m"] == pytest.approx(10 * SPAN_M, rel=1e-3)


def test_a_whole_line_is_inspected_from_end_to_end_and_a_place_on_it_has_no_length(user: User, client: Client) -> None:
    of_line, of_track = line(*COURSE), railway(*COURSE)
    mission = inspect(user, of_track)
    inspect(user, of_line, position=Point(10.02, 56.0, srid=4326))
    assert spans_of(client, of_track) == [(0, 40, mission.name)]
    assert spans_of(client, of_line) == [(0, 40, None)]


def test_only_aircraft_of_the_own_organisation_inspect(user: User, client: Client) -> None:
    of_line = line(*COURSE)
    inspect(user, of_line, (0, 10), simulated=True)
    inspect(user, of_line, (0, 10), state=TargetState.FAILED)
    inspect(a_user(organisation=Organisation.objects.create(name="Other")), of_line, (0, 10))
    Mission.objects.filter(pk=inspect(user, of_line, (0, 10)).pk).update(deleted_at=NOW)
    assert spans_of(client, of_line) == [(0, 40, None)]
    assert read_tile(tile(client)) == {}


def test_a_part_of_a_ring_that_its_ends_do_not_mean_is_said(user: User, client: Client) -> None:
    ring = line(*COURSE[:5], (10.016, 56.01), (10.0, 56.01), COURSE[0])
    inspect(user, ring, (0, 2))
    done, left = parts_of(client, ring)["parts"]
    assert (done["can_be_target"], left["can_be_target"]) == (True, False)
    assert parts_of(client, line(*COURSE))["parts"][0]["can_be_target"]


def test_what_is_no_line_or_not_drawn_as_one_is_told(client: Client) -> None:
    assert client.get(f"/api/v1/assets/{tower(COURSE[0]).pk}/inspected-parts").status_code == 404
    assert client.get("/api/v1/assets/999/inspected-parts").status_code == 404
    cut = railway(*COURSE)
    Asset.objects.filter(pk=cut.pk).update(geometry="SRID=4326;MULTILINESTRING((10 56, 10.01 56), (10.02 56, 10.03 56))")
    answer = client.get(f"/api/v1/assets/{cut.pk}/inspected-parts")
    assert (answer.status_code, answer.json()["type"]) == (400, "urn:problem-type:spanwise:not_one_line")


def test_the_register_tells_when_a_line_was_inspected_last_and_how_much_of_it(user: User, client: Client) -> None:
    of_line, of_track, support = line(*COURSE), railway(*COURSE), tower(COURSE[0])
    inspect(user, of_line, (0, 10), YEAR_AGO)
    inspect(user, of_line, (5, 20), MONTH_AGO)
    inspect(user, support)
    told = {
        feature["id"]: (feature["properties"]["inspected_at"], feature["properties"]["inspected_share"])
        for feature in client.get("/api/v1/assets").json()["features"]
    }
    assert told[of_track.pk] == (None, None)
    assert told[support.pk][1] is None
    assert (datetime.fromisoformat(told[of_line.pk][0]), told[of_line.pk][1]) == (MONTH_AGO, pytest.approx(0.5, abs=1e-3))
    assert client.get(f"/api/v1/assets/{of_line.pk}").json()["properties"]["inspected_share"] == pytest.approx(0.5, abs=1e-3)


def tile(client: Client, zoom: int = TILE[0], column: int = TILE[1], row: int = TILE[2]) -> bytes:
    answer = client.get(f"/api/v1/tiles/inspections/{zoom}/{column}/{row}")
    assert answer.status_code == 200
    return bytes(answer.content)


def drawn(client: Client, *address: int) -> list[Feature]:
    return sorted(read_tile(tile(client, *address)).get("inspections", []), key=lambda feature: feature.properties["inspected_s"])


def test_the_tiles_draw_each_inspected_part_with_its_time(user: User, client: Client) -> None:
    of_line, of_bridge = line(*COURSE), bridge((10.02, 56.0))
    inspect(user, of_line, (20, 4), YEAR_AGO - timedelta(days=2))
    inspect(user, of_line, (20, 4), YEAR_AGO)
    inspect(user, of_line, None, MONTH_AGO)
    inspect(user, of_bridge)
    part, whole, point = drawn(client)
    assert [feature.type for feature in (part, whole, point)] == [2, 2, 1]
    assert [feature.properties["inspected_s"] for feature in (part, whole, point)] == [at.timestamp() for at in (YEAR_AGO, MONTH_AGO, NOW)]
    assert part.properties["asset"] == whole.properties["asset"] == of_line.pk
    span_px = 0.004 / 360 * 2 ** TILE[0] * 4096
    assert part.first_position[0] - whole.first_position[0] == pytest.approx(4 * span_px, abs=2)
    assert [feature.type for feature in drawn(client, 9, 270, 159)] == [2, 2]  # points are too many from afar
    assert drawn(client, 10, 0, 0) == []
    assert client.get("/api/v1/tiles/inspections/3/9/0").status_code == 404


def test_a_tile_is_sent_again_only_after_another_inspection(user: User, client: Client) -> None:
    of_line = line(*COURSE)
    path = "/api/v1/tiles/inspections/{}/{}/{}".format(*TILE)
    known = client.get(path).headers["ETag"]
    assert client.get(path, headers={"If-None-Match": known}).status_code == 304
    inspect(user, of_line)
    answer = client.get(path, headers={"If-None-Match": known})
    assert (answer.status_code, answer.headers["Cache-Control"]) == (200, "private, no-cache")
