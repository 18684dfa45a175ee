"""Results of a mission as CSV, XLSX, GeoJSON and KML."""

import csv
import io
import json
import zipfile
from datetime import datetime, timedelta
from itertools import pairwise
from xml.etree import ElementTree

import pytest
from django.test import Client
from django.utils import timezone

from inspection.models import Asset
from missions.models import Approval, Mission, Uav
from missions.services.commands.dispatch import abort_mission
from missions.services.commands.flight_progress import mark_started, mark_waypoint_reached
from telemetry.models import TelemetryRecord
from telemetry.services.captures import store_captures
from tests.mavlink.decoding.photos import captured
from tests.missions.flights import dispatched, fleet
from tests.missions.worlds import World
from tests.telemetry.flown import fly, route_of
from tests.telemetry.test_captures import new
from workspace.models import User

pytestmark = pytest.mark.django_db
KML = "{http://www.opengis.net/kml/2.2}"
GX = "{http://www.google.com/kml/ext/2.2}"


@pytest.fixture
def flown(here: World, person: User) -> Mission:
    """Of three targets the last was not reached: aborted for a thunderstorm."""
    tern: Uav = fleet("Tern")[0]
    mission = dispatched(person, [tern], [here.towers[1], here.towers[3], here.bridge], name='=Spring; "south"')
    mark_started(mission_id=mission.pk, uav_id=tern.pk)
    approval = Approval.objects.get(mission=mission)
    fly(approval, tern, timezone.now() - timedelta(minutes=30))
    visited = [waypoint for waypoint in route_of(approval, tern).waypoints if waypoint.target is not None]
    last = TelemetryRecord.objects.filter(mission=mission, waypoint_sequence=visited[1].sequence).latest("measured_at")
    TelemetryRecord.objects.filter(mission=mission, measured_at__gt=last.measured_at + timedelta(seconds=4)).delete()
    mark_waypoint_reached(mission_id=mission.pk, uav_id=tern.pk, waypoint=visited[1].sequence + 1)
    abort_mission(mission=mission, actor=person, why="thunderstorm")
    return mission


def body_of(client: Client, mission: Mission, kind: str) -> bytes:
    answer = client.get(f"/api/v1/missions/{mission.pk}/results.{kind}", headers={"Accept": "text/html"})
    assert answer.status_code == 200, answer.content
    assert answer["Content-Disposition"] == f'attachment; filename="Spring-south-results.{kind}"'
    return answer.content


def parsed(written: bytes) -> ElementTree.Element:
    return ElementTree.fromstring(written)  # noqa: S314 - just written


def test_a_table_has_a_row_of_each_target_in_flown_order(client: Client, flown: Mission, here: World, person: User) -> None:
    Asset.objects.filter(pk=here.towers[1].pk).update(line=Asset.objects.filter(kind="line").first())
    rows = list(csv.DictReader(io.StringIO(body_of(client, flown, "csv").decode())))
    assert [row["result"] for row in rows] == ["inspected", "inspected", "not-inspected"]
    assert [row["reason"] for row in rows] == ["", "", f"mission aborted by {person.username}: thunderstorm"]
    assert {row["uav"] for row in rows} == {"Tern"} and any(row["line"] for row in rows)
    times = [row["reached_at"] for row in rows[:2]]
    assert times == sorted(times) and all(times) and not rows[2]["reached_at"]
    for row in rows[:2]:
        assert float(row["distance_m"]) < 15.0 and float(row["altitude_relative_m"]) > 10.0 and float(row["held_s"]) >= 0.0
        assert {int(row["asset_id"]) for row in rows} <= set(Asset.objects.values_list("pk", flat=True))


def test_a_workbook_opens_with_headings_numbers_and_times(client: Client, flown: Mission) -> None:
    book = zipfile.ZipFile(io.BytesIO(body_of(client, flown, "xlsx")))
    assert book.testzip() is None
    strings = [node.text for node in parsed(book.read("xl/sharedStrings.xml")).iter() if node.tag.endswith("}t")]
    assert {"Asset", "Line", "Result", "Reason", "Hold [s]", "Distance [m]", "Inspected", "Not inspected"} <= set(strings)
    sheet = parsed(book.read("xl/worksheets/sheet1.xml"))
    rows = [node for node in sheet.iter() if node.tag.endswith("}row")]
    assert len(rows) == 4 and not any(node.tag.endswith("}f") for node in sheet.iter()), "no formula"


def test_a_map_has_targets_incidents_photos_planned_and_flown_lines_at_one_hertz(client: Client, flown: Mission) -> None:
    tern = Uav.objects.get(name="Tern")
    store_captures([new(tern, captured(3), 1.0, mission_id=flown.pk)])
    features = json.loads(body_of(client, flown, "geojson"))["features"]
    kinds = [feature["properties"]["kind"] for feature in features]
    (photo,) = [feature for feature in features if feature["properties"]["kind"] == "photo"]
    assert (photo["properties"]["image_index"], photo["geometry"]["type"]) == (3, "Point")
    assert client.get(f"/api/v1/missions/{flown.pk}/record").json()["routes"][0]["photos"] == 1
    assert [kinds.count(kind) for kind in ("target", "incident", "planned", "flown")] == [3, 1, 1, 1]
    line = next(feature for feature in features if feature["properties"]["kind"] == "flown")
    times = [datetime.fromisoformat(moment) for moment in line["properties"]["times"]]
    assert len(times) == len(line["geometry"]["coordinates"]) == len(line["properties"]["altitudes_relative_m"])
    assert {round((after - before).total_seconds()) for before, after in pairwise(times)} == {1}
    assert all(feature["geometry"] is not None for feature in features if feature["properties"]["kind"] == "target")


def test_a_globe_has_the_same(client: Client, flown: Mission) -> None:
    root = parsed(body_of(client, flown, "kml"))
    folders = {folder.findtext(f"{KML}name"): folder for folder in root.iter(f"{KML}Folder")}
    assert [*folders] == ["Targets", "Planned", "Flown"], "the abort has no place"
    assert len(folders["Targets"].findall(f"{KML}Placemark")) == 3
    track = next(folders["Flown"].iter(f"{GX}Track"))
    assert len(track.findall(f"{KML}when")) == len(track.findall(f"{GX}coord")) > 20
    coordinates = (next(folders["Planned"].iter(f"{KML}coordinates")).text or "").split()
    assert len(coordinates) > 3


def test_results_are_in_the_readers_language(client: Client, flown: Mission) -> None:
    answer = client.get(f"/api/v1/missions/{flown.pk}/results.xlsx", headers={"Accept-Language": "de"})
    strings = zipfile.ZipFile(io.BytesIO(answer.content)).read("xl/sharedStrings.xml").decode()
    assert "Nicht inspiziert" in strings and "abgebrochen: thunderstorm" in strings


@pytest.mark.parametrize("kind", ["csv", "xlsx", "geojson", "kml"])
def test_a_mission_that_was_not_approved_has_no_results(client: Client, kind: str) -> None:
    answer = client.get(f"/api/v1/missions/{Mission.objects.create(name='Draft').pk}/results.{kind}")
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "no_results")
