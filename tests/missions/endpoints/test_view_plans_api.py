"""Photos of a tower or a bridge over the API: cameras of types and of the catalogue, plans, and what is wrong with requests."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from django.contrib.gis.geos import MultiPolygon, Polygon
from django.test import Client

from inspection.geodesy.local_frame import LocalFrame
from inspection.models import Asset
from inspection.services import import_terrain
from planning.views.catalogue import catalogue
from tests.accounts.users import a_user, client_of
from tests.inspection import ground
from tests.inspection.importers.terrain.tiffs import write_geotiff
from tests.missions.api import patch, post
from tests.missions.worlds import power_line, world, zone_around
from workspace.models import Role

pytestmark = pytest.mark.django_db

ANY = {"If-Match": "*"}
ZOOM = "dji-m30t-zoom"
CAMERA: dict[str, Any] = {
    "name": "Full frame", "sensor_width_mm": 35.9, "sensor_height_mm": 24.0, "pixels_wide": 8192, "pixels_high": 5460,
    "focal_lengths_mm": [35.0], "gimbal_pitch_min_deg": -130, "gimbal_pitch_max_deg": 40,
}  # fmt: skip


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.OPERATOR))


def planned(client: Client, body: dict[str, Any]) -> Any:
    response = post(client, "view-plans", body)
    assert response.status_code == 200, response.content
    return response.json()


def test_the_catalogue_tells_every_camera_with_its_sources(client: Client) -> None:
    rows = client.get("/api/v1/camera-catalogue").json()["results"]
    assert {row["key"] for row in rows} == set(catalogue())
    assert all(row["sources"] and row["maker"] and row["focal_lengths_mm"] for row in rows)


def test_a_type_carries_cameras_and_gives_them_back(client: Client) -> None:
    made = post(client, "uav-types", {"name": "Kestrel", "cameras": [CAMERA]})
    assert made.status_code == 201, made.content
    camera = made.json()["cameras"][0]
    assert camera.items() >= CAMERA.items()
    assert (camera["min_interval_s"], camera["is_thermal"], camera["offset_m"]) == (2.0, False, [0.0, 0.0, 0.0])
    changed = patch(client, f"uav-types/{made.json()['id']}", {"cameras": [camera, CAMERA | {"name": "Spare"}]}, **ANY)
    assert [own["name"] for own in changed.json()["cameras"]] == ["Full frame", "Spare"]


@pytest.mark.parametrize(
    ("figures", "field"),
    [({"pixels_high": 100}, "pixels_high"), ({"sensor_width_mm": 0}, "sensor_width_mm"),
     ({"focal_lengths_mm": [50, 35]}, "focal_lengths_mm"),
     ({"focal_lengths_mm": []}, "focal_lengths_mm"), ({"gimbal_pitch_min_deg": 50}, "gimbal_pitch_max_deg"), ({"zoom": 3}, "zoom")],
)  # fmt: skip
def test_a_camera_that_cannot_be_is_refused_by_its_field(client: Client, figures: dict[str, Any], field: str) -> None:
    response = post(client, "uav-types", {"name": "Kestrel", "cameras": [CAMERA | figures]})
    assert response.status_code == 400
    assert f"cameras.0.{field}" in response.json()["error"]["details"]


def test_a_changed_camera_needs_all_its_figures(client: Client) -> None:
    made = post(client, "uav-types", {"name": "Kestrel", "cameras": [CAMERA]}).json()
    response = patch(client, f"uav-types/{made['id']}", {"cameras": [{"name": "Full frame", "pixels_wide": 4000}]}, **ANY)
    assert response.status_code == 400
    assert "cameras.0.sensor_width_mm" in response.json()["error"]["details"]


def test_two_cameras_of_a_type_have_different_names(client: Client) -> None:
    response = post(client, "uav-types", {"name": "Kestrel", "cameras": [CAMERA, CAMERA | {"name": "full FRAME"}]})
    assert response.status_code == 400
    assert "cameras" in response.json()["error"]["details"]


def test_photos_of_a_tower_keep_clear_of_its_line_and_show_it(client: Client) -> None:
    towers = world(height_m=40.0).towers
    plan = planned(client, {"asset": towers[2].pk, "camera_key": ZOOM, "gsd_mm": 2})
    assert plan["model"]["height_m"] == 40.0
    assert plan["coverage"]["shown_of_reachable"] >= 0.95
    assert len(plan["photos"]) >= plan["photos_bound"] > 0
    assert plan["duration_s"] > 0
    assert plan["zones"] == []
    frame = LocalFrame.around(*towers[2].centre.coords)
    places = frame.to_metres(np.array([photo["position"] for photo in plan["photos"]]))
    under = (np.abs(places[:, 1]) < plan["clearance_m"]) & (np.array([photo["height_m"] for photo in plan["photos"]]) < 40.0)
    assert not under.any(), "the line leads east and west: no photo is taken from between its wires"
    assert max(np.hypot(*places.T)) < 100.0
    assert all(photo["height_m"] >= 4.0 for photo in plan["photos"])
    assert plan["has_terrain"] is False
    assert {photo["height_agl_m"] for photo in plan["photos"]} == {None}, "without terrain nobody knows it"
    assert {row["component"] for row in plan["coverage"]["components"]} >= {"body", "crossarm", "clamp", "string", "plate"}
    assert plan["route"][0] == plan["route"][-1]


@pytest.mark.long
def test_over_a_slope_every_photo_is_at_an_allowed_height_above_its_own_ground(client: Client, tmp_path: Path) -> None:
    tower = world(height_m=30.0).towers[2]
    slope_m = 200.0 + np.repeat(np.arange(300.0)[:, None], 300, axis=1) * 20.0  # from post to post, 111 m to the south
    import_terrain(path=write_geotiff(tmp_path / "slope.tif", slope_m.astype("f4"), srid=9707, origin=(9.95, 56.05)))
    plan = planned(client, {"asset": tower.pk, "camera_key": ZOOM, "gsd_mm": 4, "min_height_m": 8})
    assert plan["has_terrain"] is True
    heights_m = [photo["height_agl_m"] for photo in plan["photos"]]
    assert 8.0 <= min(heights_m) <= max(heights_m) <= 120.0
    assert any(abs(photo["height_agl_m"] - photo["height_m"]) > 1.0 for photo in plan["photos"]), "the ground is not level"


def test_an_overview_takes_the_whole_tower_from_four_sides_without_a_gsd(client: Client) -> None:
    asked = {"asset": world(height_m=30.0).towers[2].pk, "camera_key": "dji-m30t-wide", "pattern": "overview"}
    plan = planned(client, asked)
    assert (plan["pattern"], plan["gsd_mm"], len(plan["photos"]), plan["photos_bound"]) == ("overview", 50.0, 4, 4)
    sides = sorted((photo["yaw_deg"] - plan["model"]["bearing_deg"]) % 360.0 // 90.0 for photo in plan["photos"])
    assert sides == [0, 1, 2, 3]
    assert plan["coverage"]["shown_of_reachable"] > 0.3
    for photo in plan["photos"]:
        assert photo["pitch_deg"] <= 0.0


@pytest.mark.long
def test_wires_are_photographed_up_to_the_middle_of_each_span_however_long_it_is(client: Client) -> None:
    towers = [ground.tower((10.1 + lon, 56.1), height_m=30.0) for lon in (0.0, 0.003, 0.0122)]  # 186 m and 573 m apart
    power_line(towers)
    plan = planned(client, {"asset": towers[1].pk, "camera_key": "dji-p1-50", "gsd_mm": 8, "pattern": "spans"})
    assert (plan["pattern"], plan["gsd_mm"]) == ("spans", 8.0)
    at = LocalFrame.around(*towers[1].centre.coords).to_metres(np.array([photo["position"] for photo in plan["photos"]]))
    assert -95.0 < at[:, 0].min() < -70.0 and 240.0 < at[:, 0].max() < 290.0
    assert [(row["component"], row["number"]) for row in plan["coverage"]["components"]] == [("wires", number) for number in range(4)]
    assert all(row["shown"] >= 0.98 and row["gsd_mm"] <= 8.0 for row in plan["coverage"]["components"])


def test_a_pattern_that_is_not_known_and_a_detail_without_a_gsd_are_refused(client: Client) -> None:
    asset = world(height_m=30.0).towers[2].pk
    for body, field in (
        ({"pattern": "orbit"}, "pattern"),
        ({}, "gsd_mm"),
        ({"pattern": "detail"}, "gsd_mm"),
        ({"pattern": "spans"}, "gsd_mm"),
    ):
        response = post(client, "view-plans", {"asset": asset, "camera_key": ZOOM} | body)
        assert response.status_code == 400
        assert list(response.json()["error"]["details"]) == [field]


@pytest.mark.long
def test_a_finer_gsd_takes_more_photos_and_one_that_no_lens_reaches_none(client: Client) -> None:
    tower = world(height_m=30.0).towers[2]
    counts = [len(planned(client, {"asset": tower.pk, "camera": CAMERA, "gsd_mm": gsd_mm})["photos"]) for gsd_mm in (8, 4)]
    assert counts[0] < counts[1]
    nothing = planned(client, {"asset": tower.pk, "camera": CAMERA, "gsd_mm": 0.5})
    assert nothing["photos"] == []
    assert {row["limit"] for row in nothing["coverage"]["components"]} <= {"distance", "hidden", "height"}


def test_a_zone_around_the_tower_is_named(client: Client) -> None:
    tower = world(height_m=30.0).towers[2]
    zone = zone_around(tower.centre.coords)
    plan = planned(client, {"asset": tower.pk, "camera_key": ZOOM, "gsd_mm": 4})
    assert plan["zones"] == [{"id": zone.pk, "name": "Airport"}]


@pytest.mark.long
def test_a_parallel_line_is_kept_clear_of_too(client: Client) -> None:
    tower = world(height_m=30.0).towers[2]
    east_m = LocalFrame.around(*tower.centre.coords)
    beside = east_m.to_degrees(np.array([[-250.0, 26.0], [0.0, 26.0], [250.0, 26.0]])).tolist()
    power_line([ground.tower(tuple(place), height_m=30.0) for place in beside])
    plan = planned(client, {"asset": tower.pk, "camera_key": ZOOM, "gsd_mm": 2})
    north_m = east_m.to_metres(np.array([photo["position"] for photo in plan["photos"]]))[:, 1]
    low = np.array([photo["height_m"] for photo in plan["photos"]]) < 30.0
    assert not ((north_m > 26.0 - plan["clearance_m"]) & (north_m < 26.0 + plan["clearance_m"]) & low).any()


@pytest.mark.parametrize(
    ("body", "field"),
    [({"gsd_mm": 0}, "gsd_mm"), ({"gsd_mm": 1e9}, "gsd_mm"), ({"min_height_m": 0}, "min_height_m"), ({"camera_key": "none"}, "camera_key"),
     ({"camera": CAMERA}, "camera"), ({"asset": "no"}, "asset"), ({"gsd": 2}, "gsd")],
)  # fmt: skip
def test_what_is_wrong_with_a_request_is_told_by_field(client: Client, body: dict[str, Any], field: str) -> None:
    response = post(client, "view-plans", {"asset": 1, "camera_key": ZOOM, "gsd_mm": 2} | body)
    assert response.status_code == 400
    assert field in response.json()["error"]["details"]


def overpass(length_m: float, width_m: float, **facts: Any) -> Asset:
    """A bridge that leads east."""
    frame = LocalFrame.around(10.05, 56.05)
    corners = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)]) * (length_m / 2.0, width_m / 2.0)
    outline = MultiPolygon(Polygon(frame.to_degrees(corners).tolist()), srid=4326)
    own = ground.bridge((10.05, 56.05), **facts)
    own.geometry = outline
    own.save()
    return own


@pytest.mark.parametrize(
    ("facts", "deck_height_m", "deck_source", "top_m"),
    [
        ({}, 6.5, "layer", 34.0),
        pytest.param({"tags": {"layer": "2"}}, 13.0, "layer", 34.0, marks=pytest.mark.long),
        ({"height_m": 9.0}, 9.0, "tag", 13.0),
    ],
)
def test_photos_of_a_bridge_keep_clear_of_it_and_show_it(
    client: Client, facts: dict[str, Any], deck_height_m: float, deck_source: str, top_m: float
) -> None:
    own = overpass(40.0, 10.0, **facts)
    plan = planned(client, {"asset": own.pk, "camera_key": ZOOM, "gsd_mm": 3})
    assert plan["model"] is None
    assert plan["bridge"].pop("deck_source") == deck_source
    assert plan["bridge"] == pytest.approx(
        {"deck_height_m": deck_height_m, "top_m": top_m, "length_m": 40.0, "width_m": 10.0, "piers": 0, "bearing_deg": 90.0}, rel=1e-3
    )
    frame = LocalFrame.around(10.05, 56.05)
    route = np.array(plan["route"])
    beside_m = np.abs(frame.to_metres(route[:, :2])) - (20.0, 5.0)
    is_beside = np.linalg.norm(beside_m.clip(min=0.0), axis=1) >= plan["clearance_m"] - 0.05
    assert (is_beside | (route[:, 2] >= max(top_m, deck_height_m + 12.0) + plan["clearance_m"] - 0.05)).all()
    rows = {(row["component"], row["number"]): row for row in plan["coverage"]["components"]}
    assert set(rows) == {("deck", 0), ("underside", 0), ("face", 0), ("face", 1), ("abutment", 0), ("abutment", 1)}
    assert min(rows[kind]["shown"] for kind in (("deck", 0), ("face", 0), ("face", 1))) > 0.9
    assert plan["coverage"]["shown_of_reachable"] > 0.95


def test_an_overview_of_a_bridge_has_four_photos(client: Client) -> None:
    plan = planned(client, {"asset": overpass(40.0, 10.0).pk, "camera_key": "dji-m30t-wide", "pattern": "overview"})
    assert len(plan["photos"]) == 4


def test_a_bridge_with_pylons_of_unknown_height_is_refused(client: Client) -> None:
    own = overpass(40.0, 10.0, tags={"bridge:structure": "cable-stayed"})
    body = {"asset": own.pk, "camera_key": ZOOM, "gsd_mm": 3}
    refused = post(client, "view-plans", body)
    assert (refused.status_code, refused.json()["error"]["code"]) == (409, "bridge_height_unknown")
    own.height_m = 50.0
    own.save()
    bridge = planned(client, body)["bridge"]
    assert bridge["top_m"] >= 50.0
    assert (bridge["deck_height_m"], bridge["deck_source"]) == (6.5, "layer"), "the stated height is that of its pylons"


@pytest.mark.parametrize(
    "facts",
    [{"tags": {"bridge": "suspension"}}, {"tags": {"bridge:structure": "truss; Simple_Suspension"}},
     {"tags": {"man_made": "bridge"}, "parts": [{"osm_id": 7, "tags": {"layer": "1"}}, {"osm_id": 8, "tags": {"bridge:movable": "lift"}}]}],
)  # fmt: skip
def test_pylons_are_read_from_any_tag_of_a_bridge_and_its_ways(client: Client, facts: dict[str, Any]) -> None:
    refused = post(client, "view-plans", {"asset": overpass(40.0, 10.0, **facts).pk, "camera_key": ZOOM, "gsd_mm": 3})
    assert refused.json()["error"]["code"] == "bridge_height_unknown"


@pytest.mark.parametrize(("length_m", "code"), [(700.0, "bridge_too_long"), (0.5, "bridge_outline")])
def test_bridges_without_a_model_are_refused(client: Client, length_m: float, code: str) -> None:
    refused = post(client, "view-plans", {"asset": overpass(length_m, 1.0).pk, "camera_key": ZOOM, "gsd_mm": 3})
    assert (refused.status_code, refused.json()["error"]["code"]) == (409, code)


def test_a_bridge_beside_it_hides_the_inner_face(client: Client) -> None:
    own, beside = overpass(40.0, 10.0), overpass(40.0, 10.0)
    metres = LocalFrame.around(10.05, 56.05).metres_per_degree_north
    moved = [[(lon, lat + 10.4 / metres) for lon, lat in ring] for ring in beside.geometry.coords[0]]
    beside.geometry = MultiPolygon(Polygon(*moved), srid=4326)
    beside.save()
    rows = planned(client, {"asset": own.pk, "camera_key": ZOOM, "gsd_mm": 3})["coverage"]["components"]
    faces = sorted(row["shown"] for row in rows if row["component"] == "face")
    assert faces[0] < 0.6 < 0.9 < faces[1]


def test_only_towers_of_lines_and_bridges_are_planned(client: Client) -> None:
    here = world()
    for asset, pattern in ((here.railway, "detail"), (here.line, "detail"), (here.bridge, "spans")):
        answer = post(client, "view-plans", {"asset": asset.pk, "camera_key": ZOOM, "gsd_mm": 2, "pattern": pattern})
        assert answer.json()["error"]["code"] == "not_a_tower"
    assert post(client, "view-plans", {"asset": 10**9, "camera_key": ZOOM, "gsd_mm": 2}).status_code == 404
    assert post(Client(), "view-plans", {"asset": here.bridge.pk, "camera_key": ZOOM, "gsd_mm": 2}).status_code in {401, 403}
