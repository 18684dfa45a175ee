"""Picking many assets at once over HTTP: a list, an area, the supports of a line, a stretch, the bridges of a railway."""

import json
from typing import Any

import pytest
from django.http import HttpResponse
from django.test import Client

from inspection.models import Asset
from inspection.selectors.asset_names import MadeName, made_name
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import bridge, line, railway, tower
from workspace.models import Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.VIEWER))


def post(client: Client, path: str, body: Any) -> HttpResponse:
    return client.post(f"/api/v1/assets/{path}", json.dumps(body), content_type="application/json")


def lookup(client: Client, *refs: str, **more: Any) -> dict[str, tuple[str, list[int]]]:
    answer = post(client, "lookup", {"refs": list(refs)} | more)
    assert answer.status_code == 200, answer.content
    return {result["ref"]: (result["match"], [asset["id"] for asset in result["assets"]]) for result in answer.json()["results"]}


def row_of_towers(*lons: float, lat: float = 56.0, **facts: Any) -> list[Asset]:
    return [tower((lon, lat), **facts) for lon in lons]


def line_over(towers: list[Asset], **facts: Any) -> Asset:
    return line(*[mast.centre.coords for mast in towers], node_osm_ids=[mast.osm_id for mast in towers], **facts)


def ids(rows: list[dict[str, Any]]) -> list[int]:
    return [row["id"] for row in rows]


# --- lists -------------------------------------------------------------------------------------------------------------------------


def test_a_list_says_of_each_reference_what_it_means(client: Client) -> None:
    north = line(ref="L 12")
    first, second = tower((10.0, 56.0), ref="41"), tower((10.1, 56.0), ref="41")
    assert lookup(client, "l  12", "41", "99") == {
        "l  12": ("found", [north.pk]),
        "41": ("several", [first.pk, second.pk]),
        "99": ("none", []),
    }


def test_a_list_may_name_osm_ids_and_addresses(client: Client) -> None:
    mast, way = tower(osm_id=42), line(osm_id=42)
    found = lookup(client, "n42", "way/42", "https://www.openstreetmap.org/node/42#map=12/1/2", "r42")
    assert [match for match, _ in found.values()] == ["found", "found", "found", "none"]
    assert [keys for _, keys in found.values()] == [[mast.pk], [way.pk], [mast.pk], []]


def test_an_own_reference_comes_before_one_of_several_and_before_a_name(client: Client) -> None:
    own = tower(ref="7")
    shared = tower(ref="7;8")
    tower(name="7")
    assert lookup(client, "7", "8") == {"7": ("found", [own.pk]), "8": ("found", [shared.pk])}


def test_a_list_may_name_things_as_the_page_names_them(client: Client) -> None:
    """In any language of the pages. A tower that has a reference is called by it, and by nothing else."""
    masts = [*row_of_towers(10.0, 10.1), tower((10.2, 56.0), ref="T3")]
    for place, mast in enumerate(masts, start=1):
        Asset.objects.filter(pk=mast.pk).update(line=line_over(masts), place_on_line=place, places_on_line=3)
    crossing, drawn = bridge(osm_type="w", osm_id=29_492_007), tower((10.3, 56.0), osm_type="", osm_id=None)
    shown = [row["label"] for row in found(client, "limit=50")["features"] if row["id"] == masts[0].pk for row in [row["properties"]]]
    assert shown == ["Tower 1 of 3"]
    asked = lookup(
        client,
        "Tower 1 of 3",
        "tower  2 OF 3",
        "Mast 2 von 3",
        "Tower 3 of 3",
        "Bridge w29492007",
        "Brücke w29492007",
        "Tower w29492007",
        f"Tower {drawn.pk}",
    )
    assert list(asked.values()) == [
        ("found", [masts[0].pk]), ("found", [masts[1].pk]), ("found", [masts[1].pk]), ("none", []),
        ("found", [crossing.pk]), ("found", [crossing.pk]), ("none", []), ("found", [drawn.pk]),
    ]  # fmt: skip


@pytest.mark.parametrize(("text", "place"), [("Tower 1 of 3", 1), ("Mast 2 von 3", 2)])
def test_a_search_finds_things_by_the_names_that_the_page_gives_them(client: Client, text: str, place: int) -> None:
    masts = row_of_towers(10.0, 10.1)
    for number, mast in enumerate(masts, start=1):
        Asset.objects.filter(pk=mast.pk).update(line=line_over(masts), place_on_line=number, places_on_line=3)
    assert ids(found(client, f"text={text}")["features"]) == [masts[place - 1].pk]


def test_letters_that_change_their_number_in_capitals_do_not_hide_a_name(client: Client) -> None:
    mast = tower(name="Weißenthurm Süd")
    assert lookup(client, "weißenthurm SÜD") == {"weißenthurm SÜD": ("found", [mast.pk])}


def test_a_list_may_be_of_one_kind(client: Client) -> None:
    mast, way = tower(ref="A"), line(ref="A")
    assert lookup(client, "A") == {"A": ("several", [mast.pk, way.pk])}
    assert lookup(client, "A", kinds=["line"]) == {"A": ("found", [way.pk])}


def test_a_list_leaves_out_what_may_not_be_flown_to(client: Client) -> None:
    tower(ref="A", is_flyable=False)
    assert lookup(client, "A") == {"A": ("none", [])}


def test_a_reference_asked_twice_is_answered_once(client: Client) -> None:
    tower(ref="A")
    assert list(lookup(client, "A", "a ", "b")) == ["A", "b"]


@pytest.mark.parametrize("refs", [[], "A", ["x"] * 2_001, ["x" * 256], [{}], None])
def test_a_list_that_makes_no_sense_is_refused(client: Client, refs: Any) -> None:
    assert post(client, "lookup", {"refs": refs}).status_code == 400


# --- areas -------------------------------------------------------------------------------------------------------------------------


def within(client: Client, ring: list[list[float]], **more: Any) -> HttpResponse:
    return post(client, "within", {"polygon": {"type": "Polygon", "coordinates": [ring]}} | more)


def test_an_area_holds_the_towers_and_bridges_that_stand_in_it(client: Client) -> None:
    inside, _outside = tower((10.0, 56.0)), tower((10.2, 56.0))
    over = bridge((10.01, 56.0))
    way = line((10.0, 56.0), (10.01, 56.0))
    triangle = [[9.9, 55.9], [10.1, 55.9], [10.0, 56.1]]
    answer = within(client, triangle).json()
    assert (answer["count"], ids(answer["assets"])) == (2, [inside.pk, over.pk])
    assert ids(within(client, triangle, kinds=["line"]).json()["assets"]) == [way.pk]


def test_a_line_that_crosses_itself_hundreds_of_times_is_refused_before_it_is_sorted_out(client: Client) -> None:
    tangle = [[10.0 + 0.001 * (corner * 7_919 % 1_000), 56.0 + 0.001 * (corner * 104_729 % 997)] for corner in range(1_000)]
    answer = within(client, tangle)
    assert (answer.status_code, answer.json()["error"]["details"]) == (400, {"polygon": ["It crosses itself too often."]})


def test_a_line_that_stands_still_at_a_corner_does_not_cross_itself(client: Client) -> None:
    mast = tower()
    corners = [[9.9, 55.9], [10.1, 55.9], [10.1, 56.1], [9.9, 56.1]]
    assert ids(within(client, [corner for corner in corners for _ in range(400)]).json()["assets"]) == [mast.pk]


def test_an_area_whose_line_crosses_itself_holds_both_loops(client: Client) -> None:
    west, east = tower((9.95, 56.0)), tower((10.05, 56.0))
    bow = [[9.9, 55.9], [10.1, 56.1], [10.1, 55.9], [9.9, 56.1], [9.9, 55.9]]
    assert ids(within(client, bow).json()["assets"]) == [west.pk, east.pk]


def test_an_area_may_lie_over_the_180th_meridian(client: Client) -> None:
    west, east = tower((179.9, 0.0)), tower((-179.9, 0.0))
    assert ids(within(client, [[179.0, -1.0], [181.0, -1.0], [181.0, 1.0], [179.0, 1.0]]).json()["assets"]) == [west.pk, east.pk]


@pytest.mark.parametrize(
    "ring",
    [
        [],
        [[10, 56], [11, 56]],
        [[10, 56], [10, 56], [10, 56]],
        [[10, 56], [11, 56], [11, 95]],
        [[10, 56], [11, 56], ["x", 56]],
        [[10.0, 56.0], [11.0, 56.0], [float("nan"), 57.0]],
        [[10, 56], [11, 56], [1e999, 57]],
    ],
)
def test_an_area_that_encloses_nothing_on_the_globe_is_refused(client: Client, ring: list[list[Any]]) -> None:
    assert within(client, ring).status_code == 400


def test_an_area_says_how_many_stand_there_beyond_what_it_lists(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("inspection.selectors.picking.MAX_IN_AN_AREA", 2)
    masts = row_of_towers(10.0, 10.01, 10.02)
    answer = within(client, [[9.9, 55.9], [10.1, 55.9], [10.1, 56.1], [9.9, 56.1]]).json()
    assert (answer["count"], ids(answer["assets"])) == (3, [masts[0].pk, masts[1].pk])


# --- along lines -------------------------------------------------------------------------------------------------------------------


def test_supports_of_a_line_come_in_its_direction(client: Client) -> None:
    east, middle, west = row_of_towers(10.02, 10.01, 10.0)
    tower((10.005, 56.0))  # stands beside
    way = line_over([west, middle, east])
    answer = client.get(f"/api/v1/assets/{way.pk}/supports").json()
    assert ids(answer["supports"]) == [west.pk, middle.pk, east.pk]
    assert answer["length_m"] == 1_500.0


def test_a_support_of_two_lines_is_listed_on_both(client: Client) -> None:
    masts = row_of_towers(10.0, 10.01, 10.02)
    upper, lower = line_over(masts, voltages_v=[380_000]), line_over(masts[::-1], voltages_v=[110_000])
    assert ids(client.get(f"/api/v1/assets/{upper.pk}/supports").json()["supports"]) == [mast.pk for mast in masts]
    assert ids(client.get(f"/api/v1/assets/{lower.pk}/supports").json()["supports"]) == [mast.pk for mast in masts[::-1]]


def test_a_line_between_two_of_its_supports_goes_either_way(client: Client) -> None:
    masts = row_of_towers(10.0, 10.01, 10.02, 10.03)
    way = line_over(masts)
    ask = f"/api/v1/assets/{way.pk}/supports?from={{}}&to={{}}"
    assert ids(client.get(ask.format(masts[1].pk, masts[3].pk)).json()["supports"]) == [mast.pk for mast in masts[1:]]
    assert ids(client.get(ask.format(masts[2].pk, masts[0].pk)).json()["supports"]) == [masts[2].pk, masts[1].pk, masts[0].pk]
    elsewhere = tower((11.0, 56.0))
    answer = client.get(ask.format(masts[0].pk, elsewhere.pk))
    assert (answer.status_code, answer.json()["error"]["code"]) == (400, "not_on_line")


@pytest.mark.parametrize("query", ["from=1", "from=0&to=0", "from=x&to=y", "from=99999999999999999999&to=1"])
def test_ends_that_are_no_supports_are_refused(client: Client, query: str) -> None:
    assert client.get(f"/api/v1/assets/{line().pk}/supports?{query}").status_code == 400
    assert client.get(f"/api/v1/assets/stretch?{query}").status_code == 400


def test_only_a_line_has_supports(client: Client) -> None:
    assert client.get(f"/api/v1/assets/{tower().pk}/supports").status_code == 404


def test_a_stretch_goes_on_over_several_lines(client: Client) -> None:
    """t0 - t1 - t2 | t2 - t3 - t4: two lines that meet in t2."""
    masts = row_of_towers(10.0, 10.01, 10.02, 10.03, 10.04)
    west, east = line_over(masts[:3]), line_over(masts[2:])
    answer = client.get(f"/api/v1/assets/stretch?from={masts[1].pk}&to={masts[3].pk}").json()
    assert ids(answer["supports"]) == [mast.pk for mast in masts[1:4]]
    assert [part["line"]["id"] for part in answer["parts"]] == [west.pk, east.pk]
    assert [part["stretch"] for part in answer["parts"]] == [[[10.01, 56.0], [10.02, 56.0]], [[10.02, 56.0], [10.03, 56.0]]]
    assert answer["length_m"] == pytest.approx(sum(part["length_m"] for part in answer["parts"]))
    assert answer["length_m"] == pytest.approx(1_248, rel=0.01)  # 0.02° of longitude at 56° N


def test_a_stretch_stays_on_the_circuit_of_both_ends(client: Client) -> None:
    r"""110 kV straight on from a to b, 380 kV over a tower farther north: both ends carry 380 kV, only the first one 110 kV.

        a ------ m ------ b     110 kV from a to m, no voltage from m to b
         \___ n ___/            380 kV
    """  # fmt: skip
    a, m, b = row_of_towers(10.0, 10.01, 10.02)
    n = tower((10.01, 56.002))
    line_over([a, m], voltages_v=[110_000])
    line_over([m, b])
    high = line_over([a, n, b], voltages_v=[380_000])
    answer = client.get(f"/api/v1/assets/stretch?from={a.pk}&to={b.pk}").json()
    assert ids(answer["supports"]) == [a.pk, n.pk, b.pk]
    assert [part["line"]["id"] for part in answer["parts"]] == [high.pk]


def test_a_stretch_over_shared_towers_is_of_one_line(client: Client) -> None:
    masts = row_of_towers(10.0, 10.01, 10.02, 10.03)
    line_over(masts[:2], voltages_v=[110_000])
    whole = line_over(masts, voltages_v=[110_000])
    answer = client.get(f"/api/v1/assets/stretch?from={masts[0].pk}&to={masts[3].pk}").json()
    assert [part["line"]["id"] for part in answer["parts"]] == [whole.pk]


def test_where_no_line_leads_there_is_no_stretch(client: Client) -> None:
    near, far = row_of_towers(10.0, 10.01), row_of_towers(10.1, 10.11)
    line_over(near)
    line_over(far)
    answer = client.get(f"/api/v1/assets/stretch?from={near[0].pk}&to={far[0].pk}")
    assert (answer.status_code, answer.json()["error"]["code"]) == (404, "no_way_along_lines")
    assert client.get(f"/api/v1/assets/stretch?from={near[0].pk}&to={near[0].pk}").status_code == 400


# --- parts that UAVs share ----------------------------------------------------------------------------------------------------------


def test_a_line_comes_in_parts_from_tower_to_tower_that_are_targets_of_a_mission(client: Client) -> None:
    """Ten spans of 625 m; between two of the towers the line has a vertex without one."""
    masts = row_of_towers(*(10.0 + 0.01 * number for number in range(11)))
    course = [mast.centre.coords for mast in masts]
    way = line(*course[:4], (10.032, 56.0), *course[4:], ref="E402")
    answer = client.get(f"/api/v1/assets/{way.pk}/parts").json()
    assert len(answer["parts"]) == 6
    assert [part["line"]["id"] for part in answer["parts"]] == [way.pk] * 6
    assert [part["label"] for part in answer["parts"]][:2] == ["E402, km 0.0–1.2", "E402, km 1.2–1.9"]
    assert {end[0] for part in answer["parts"] for end in part["stretch"]} <= {lon for lon, _ in course}
    assert answer["length_m"] == pytest.approx(sum(part["length_m"] for part in answer["parts"])) == pytest.approx(6_240, rel=0.01)


def test_only_the_stretch_between_two_places_is_divided_if_it_is_asked_for(client: Client) -> None:
    way = line_over(row_of_towers(*(10.0 + 0.01 * number for number in range(11))))
    parts = client.get(f"/api/v1/assets/{way.pk}/parts?ends=10.08,56.0,10.02,56.0&part_m=1250").json()["parts"]
    assert [part["stretch"] for part in parts] == [
        [[10.02, 56.0], [10.04, 56.0]], [[10.04, 56.0], [10.06, 56.0]], [[10.06, 56.0], [10.08, 56.0]],
    ]  # fmt: skip


def test_a_railway_is_divided_at_its_vertices(client: Client) -> None:
    track = railway(*((10.0 + 0.01 * number, 56.0) for number in range(11)))
    assert len(client.get(f"/api/v1/assets/{track.pk}/parts").json()["parts"]) == 6


@pytest.mark.parametrize(
    "query", ["part_m=0", "part_m=x", "ends=10", "ends=10,56,11", "ends=56.0,10.0,nan,1", "ends=10,56,10,956", "ends=10,56,10,56"]
)
def test_parts_that_cannot_be_are_refused(client: Client, query: str) -> None:
    answer = client.get(f"/api/v1/assets/{line().pk}/parts?{query}")
    assert (answer.status_code, answer.json()["error"]["code"]) == (400, "invalid")


def test_a_tower_has_no_parts(client: Client) -> None:
    assert client.get(f"/api/v1/assets/{tower().pk}/parts").status_code == 404


def test_several_lines_have_no_more_parts_together_than_asked_for(client: Client) -> None:
    long = line_over(row_of_towers(*(10.0 + 0.01 * number for number in range(31))), length_m=18_700.0)
    short = line_over(row_of_towers(10.0, 10.002, lat=56.1), length_m=125.0)
    track = railway(*((10.0 + 0.01 * number, 56.2) for number in range(11)), length_m=6_240.0)
    for most in (500, 12, 4):
        answer = post(client, "parts", {"assets": [long.pk, short.pk, track.pk], "most": most}).json()
        assert {part["line"]["id"] for part in answer["parts"]} == {long.pk, short.pk, track.pk}
        assert len(answer["parts"]) <= most
        assert answer["length_m"] == pytest.approx(18_720 + 125 + 6_240, rel=0.01)


def test_of_lines_in_an_area_only_the_parts_that_come_into_it_are_given(client: Client) -> None:
    way = line_over(row_of_towers(*(10.0 + 0.01 * number for number in range(31))), length_m=18_700.0)
    elsewhere = line_over(row_of_towers(11.0, 11.05), length_m=3_100.0)
    ring = [[10.095, 55.9], [10.205, 55.9], [10.205, 56.1], [10.095, 56.1]]
    body = {"assets": [way.pk, elsewhere.pk], "polygon": {"type": "Polygon", "coordinates": [ring]}}
    parts = post(client, "parts", body).json()["parts"]
    assert {part["line"]["id"] for part in parts} == {way.pk}
    assert all(any(10.095 <= lon <= 10.205 for lon, _ in part["stretch"]) for part in parts)
    assert parts[0]["stretch"][0][0] <= 10.1 and parts[-1]["stretch"][1][0] >= 10.2
    narrow = [[10.1425, 55.9], [10.1435, 55.9], [10.1435, 56.1], [10.1425, 56.1]]
    assert len(post(client, "parts", body | {"polygon": {"type": "Polygon", "coordinates": [narrow]}}).json()["parts"]) == 1
    assert len(post(client, "parts", body | {"most": 3}).json()["parts"]) <= 3


@pytest.mark.parametrize("body", [{}, {"assets": []}, {"assets": [999_999]}, {"assets": ["x"]}, {"assets": [1], "most": 0}])
def test_parts_of_what_is_no_line_are_refused(client: Client, body: dict[str, Any]) -> None:
    assert post(client, "parts", body).status_code == 400


# --- bridges of a railway ----------------------------------------------------------------------------------------------------------


def test_bridges_of_a_railway_are_those_that_carry_it(client: Client) -> None:
    track = railway((10.0, 56.0), (10.1, 56.0))
    carries = bridge((10.02, 56.0), tags={"railway": "rail"})
    over = bridge((10.04, 56.0), tags={"highway": "primary"})
    bridge((10.06, 56.1), tags={"railway": "rail"})
    assert ids(client.get(f"/api/v1/assets/{track.pk}/bridges").json()["bridges"]) == [carries.pk]
    assert ids(client.get(f"/api/v1/assets/{track.pk}/bridges?over=true").json()["bridges"]) == [carries.pk, over.pk]


def test_bridges_of_the_other_sections_come_where_asked(client: Client) -> None:
    west = railway((10.0, 56.0), (10.1, 56.0), ref="CSX 7")
    railway((10.1, 56.0), (10.2, 56.0), ref="CSX 7")
    railway((11.0, 56.0), (11.1, 56.0), ref="CSX 7")  # of the same name far away: another railway
    railway((10.2, 56.0), (10.3, 56.0), ref="other")
    on_west, on_east = bridge((10.05, 56.0), tags={"railway": "rail"}), bridge((10.15, 56.0), tags={"railway": "rail"})
    bridge((11.05, 56.0), tags={"railway": "rail"})
    bridge((10.25, 56.0), tags={"railway": "rail"})
    own = client.get(f"/api/v1/assets/{west.pk}/bridges").json()
    every = client.get(f"/api/v1/assets/{west.pk}/bridges?sections=all").json()
    assert (own["sections"], ids(own["bridges"])) == (1, [on_west.pk])
    assert (every["sections"], ids(every["bridges"])) == (2, [on_west.pk, on_east.pk])


def test_a_railway_without_name_has_no_other_sections(client: Client) -> None:
    track = railway((10.0, 56.0), (10.1, 56.0))
    railway((10.1, 56.0), (10.2, 56.0))
    assert client.get(f"/api/v1/assets/{track.pk}/bridges?sections=all").json() == {"sections": 1, "bridges": []}


# --- search ------------------------------------------------------------------------------------------------------------------------


def found(client: Client, query: str) -> dict[str, Any]:
    answer = client.get(f"/api/v1/assets?{query}")
    assert answer.status_code == 200, answer.content
    return answer.json()


def test_a_number_alone_is_a_reference_or_a_voltage(client: Client) -> None:
    by_voltage = line(voltages_v=[138_000], operator="AEP")
    by_ref = tower(ref="138")
    other = line(voltages_v=[138_000], operator="DP&L")
    assert set(ids(found(client, "text=138")["features"])) == {by_voltage.pk, by_ref.pk, other.pk}
    assert ids(found(client, "text=AEP 138")["features"]) == [by_voltage.pk]


def test_a_search_says_how_many_there_are_where_asked(client: Client) -> None:
    row_of_towers(10.0, 10.01, 10.02, operator="AEP")
    tower((10.03, 56.0), operator="AEP", is_flyable=False)
    assert "total" not in found(client, "text=AEP&limit=2")
    assert found(client, "text=AEP&limit=2&total=true")["total"] == 4
    page = found(client, "text=AEP&limit=2&total=true&flyable=true")
    assert (page["total"], len(page["features"])) == (3, 2)


@pytest.mark.parametrize(
    ("text", "made"),
    [
        ("Tower 18 of 41", MadeName("Tower", place=(18, 41))),
        ("mast  18 VON 41", MadeName("Tower", place=(18, 41))),
        ("U-Bahn w5", MadeName("Subway", osm=("w", 5))),
        ("Vía férrea 12", MadeName("Railway", number=12)),
        ("Voie ferrée W7", MadeName("Railway", osm=("w", 7))),
        ("Pylône 3 sur 12", MadeName("Tower", place=(3, 12))),
        ("Ma\u017ft 3", None),
        ("Somebody 12", None),
    ],
)
def test_generated_names_are_found_in_every_language(text: str, made: MadeName | None) -> None:
    assert made_name(text) == made
