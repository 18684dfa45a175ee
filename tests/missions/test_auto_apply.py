"""An import that asks for it is applied once it is read, unless it breaks a bound or touches a mission that is flown: it says which."""

import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from django.core.management import call_command
from django.core.management.base import CommandError
from django.db import connection
from django.test import Client
from django.utils import timezone

from inspection.models import Asset, ImportProposal, NoFlyZone
from inspection.selectors import ground_revision
from inspection.services.imports.uploads import store_upload
from inspection.services.proposals import pipeline
from inspection.tasks import apply_proposal, read_proposal, settle_proposals
from missions.models import Mission, MissionState
from telemetry.models import UavLink
from tests.accounts.users import a_user, client_of
from tests.inspection.imports.osm_files import small_line, write_osm
from tests.inspection.imports.zone_sets import zone_file
from tests.missions.api import mission_body, post
from tests.missions.commands.outbox import a_uav
from tests.missions.worlds import World, world
from tests.workspace.api.test_token_scopes import with_token
from workspace.models import Job, Organisation, Role, User

pytestmark = pytest.mark.django_db

FAR = 30.0  # degrees of longitude: far from the world of the missions
FLOWN = (10.008, 56.0)  # on the line that the mission inspects


@pytest.fixture
def curator() -> User:
    return a_user(Role.CURATOR)


@pytest.fixture
def client(curator: User) -> Client:
    return client_of(curator)


def asked(client: Client, content: bytes, kind: str = "zones", name: str = "works.geojson", **body: Any) -> Any:
    upload = store_upload(file_name=name, chunks=[content], created_by=None)
    body = {"kind": kind, "upload": str(upload.pk), "parameters": {}, "auto_apply": True} | body
    return client.post("/api/v1/imports", body, content_type="application/json")


def brought_in(client: Client, content: bytes, kind: str = "zones", name: str = "works.geojson", **body: Any) -> dict[str, Any]:
    """What workers make of it: they read it, and apply it where it goes on."""
    answer = asked(client, content, kind, name, **body)
    assert answer.status_code == 202, answer.content
    proposal = answer.json()
    read_proposal(proposal["job"]["id"])
    return carried_on(client, proposal["id"])


def carried_on(client: Client, key: str) -> dict[str, Any]:
    proposal = client.get(f"/api/v1/imports/{key}").json()
    if proposal["state"] == "applying":
        apply_proposal(proposal["job"]["id"])
    return client.get(f"/api/v1/imports/{key}").json()


def codes(proposal: dict[str, Any]) -> list[str]:
    return [reason["code"] for reason in proposal["held_back"]]


def towers(*rows: tuple[str, float, float], height_m: float = 30.0) -> bytes:
    features = [
        {"type": "Feature", "properties": {"nr": nr, "height": height_m}, "geometry": {"type": "Point", "coordinates": [lon, lat]}}
        for nr, lon, lat in rows
    ]
    return json.dumps({"type": "FeatureCollection", "features": features}).encode()


TOWERS = {"set_name": "Masts", "kind": "tower", "columns": {"key": "nr", "ref": "nr", "height": "height"}}


def masts(client: Client, *rows: tuple[str, float, float], height_m: float = 30.0, **body: Any) -> dict[str, Any]:
    return brought_in(client, towers(*rows, height_m=height_m), "assets", parameters=TOWERS | body.pop("parameters", {}), **body)


def row_of_masts(number: int, lon: float = FAR) -> list[tuple[str, float, float]]:
    return [(f"M{place}", lon + 0.001 * place, 47.0) for place in range(number)]


def flown_mission(here: World, state: MissionState = MissionState.ACTIVE) -> Mission:
    made = post(client_of(a_user(Role.OPERATOR)), "missions", mission_body(here.towers[1], here.towers[5], plan=True)).json()
    Mission.objects.filter(pk=made["id"]).update(state=state)
    return Mission.objects.get(pk=made["id"])


def test_an_import_within_its_bounds_is_applied_once_it_is_read(client: Client, curator: User) -> None:
    applied = brought_in(client, zone_file(("A", FAR), ("B", FAR + 0.2)))
    assert (applied["state"], applied["held_back"], applied["decided_by"]) == ("applied", [], curator.username)
    assert (applied["auto_apply"], applied["max_removed_percent"]) == (True, 5.0)
    assert sorted(NoFlyZone.objects.values_list("name", flat=True)) == ["A", "B"]


def test_an_import_that_does_not_ask_for_it_waits_as_before(client: Client) -> None:
    ready = brought_in(client, zone_file(("A", FAR)), auto_apply=False)
    assert (ready["state"], ready["auto_apply"], ready["max_removed_percent"], ready["held_back"]) == ("ready", False, 5.0, [])


def test_a_file_with_records_that_are_not_read_is_held_back(client: Client) -> None:
    broken = b"AC R\nAN West\nDP 47:00:00 N 030:00:00 E\nDP 47:10:00 N 030:00:00 E\nDP 47:10:00 N 030:10:00 E\n"
    broken += b"AC R\nAN East\nDP 47:00:00 N 031:00:00 E\nDP 47:10:77 N 031:00:00 E\nDP 47:10:00 N 031:10:00 E\n"
    held = brought_in(client, broken, name="national.txt", parameters={"leave_out_faulty": True})
    assert (held["state"], codes(held), held["decided_by"]) == ("ready", ["not_read"], None)
    assert held["held_back"][0]["message"] == "Records of the file that have a fault and are left out: 1."
    german = client.get(f"/api/v1/imports/{held['id']}", headers={"Accept-Language": "de"}).json()
    assert german["held_back"][0]["message"] == "Datensätze der Datei, die fehlerhaft sind und ausgelassen werden: 1."
    assert not NoFlyZone.objects.exists()


def test_a_file_with_faulty_rows_of_assets_is_held_back(client: Client) -> None:
    held = masts(client, *row_of_masts(3), ("Lost", 500.0, 95.0), parameters={"leave_out_faulty": True})
    assert (held["state"], codes(held)) == ("ready", ["not_read"])


def test_a_file_with_values_that_cannot_be_read_is_held_back(client: Client) -> None:
    """The tops of its towers would be forgotten."""
    masts(client, *row_of_masts(2))
    unread = towers(*row_of_masts(2)).replace(b'"height": 30.0', b'"height": "high"')
    held = brought_in(client, unread, "assets", parameters=TOWERS)
    assert (held["state"], codes(held)) == ("ready", ["not_read"])
    assert held["held_back"][0]["message"] == "Values of the file that cannot be read and would be empty: 2."
    assert set(Asset.objects.values_list("height_m", flat=True)) == {30.0}


def test_a_file_whose_columns_nobody_has_explained_is_held_back_and_goes_on_once_they_are(client: Client) -> None:
    held = brought_in(client, towers(*row_of_masts(2)), "assets", parameters={"set_name": "Masts"})
    assert (held["state"], codes(held)) == ("ready", ["needs_mapping"])
    again = client.patch(f"/api/v1/imports/{held['id']}", {"parameters": TOWERS}, content_type="application/json").json()
    assert again["held_back"] == []
    read_proposal(again["job"]["id"])
    assert carried_on(client, held["id"])["state"] == "applied"


def test_a_file_that_removes_more_than_the_bound_is_held_back(client: Client) -> None:
    assert masts(client, *row_of_masts(20))["state"] == "applied"
    assert masts(client, *row_of_masts(19))["state"] == "applied"  # 1 of 20: 5 %
    held = masts(client, *row_of_masts(18))
    assert (held["state"], codes(held)) == ("ready", ["removed"])
    assert held["held_back"][0]["message"] == "It removes 1 of 19 rows of its source, 5.26 %; at most 5 % may be removed."
    assert Asset.objects.filter(vanished_at=None).count() == 19
    assert masts(client, *row_of_masts(18), max_removed_percent=6.0)["state"] == "applied"
    assert codes(masts(client, *row_of_masts(17), max_removed_percent=0.0)) == ["removed"]


def test_the_bound_counts_all_rows_and_not_the_stored_changes(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pipeline, "MAX_CHANGES_KEPT", 1)
    masts(client, *row_of_masts(20))
    held = masts(client, *row_of_masts(15))
    assert held["held_back"][0]["message"].startswith("It removes 5 of 20 rows")
    assert ImportProposal.objects.get(pk=held["id"]).changes.filter(action="vanished").count() == 1


def test_removed_zones_and_assets_of_openstreetmap_count_too(client: Client, tmp_path: Path) -> None:
    brought_in(client, zone_file(("A", FAR), ("B", FAR + 0.2)))
    assert codes(brought_in(client, zone_file(("A", FAR)))) == ["removed"]
    nodes, ways = small_line()
    first = write_osm(tmp_path / "a.osm", nodes, ways)
    assert brought_in(client, first.read_bytes(), "osm", "a.osm")["state"] == "applied"
    nodes, ways = small_line(without={1})
    following = write_osm(tmp_path / "b.osm", nodes, ways)
    held = brought_in(client, following.read_bytes(), "osm", "a.osm")
    assert (held["state"], codes(held)) == ("ready", ["removed"])
    assert not Asset.objects.filter(vanished_at__isnull=False).exists()


@pytest.mark.parametrize("state", [MissionState.DISPATCHED, MissionState.ACTIVE])
def test_a_zone_at_a_mission_that_is_flown_or_was_sent_is_held_back(client: Client, state: MissionState) -> None:
    flown_mission(world(), state)
    revision = ground_revision()
    held = brought_in(client, zone_file(("Fire", 9.99), south=55.95))
    assert (held["state"], codes(held), held["decided_by"], held["data_import"]) == ("ready", ["flown_missions"], None, None)
    assert held["held_back"][0]["message"].endswith("routes it touches: 1.")
    assert held["job"]["message"] == "Held back: look at the difference."
    assert (NoFlyZone.objects.count(), ground_revision()) == (0, revision)


@pytest.mark.parametrize("state", [MissionState.PLANNED, MissionState.APPROVED, MissionState.COMPLETED])
def test_missions_on_the_ground_hold_nothing_back(client: Client, state: MissionState) -> None:
    flown_mission(world(), state)
    assert brought_in(client, zone_file(("Fire", 9.99), south=55.95))["state"] == "applied"


def test_an_aborted_mission_counts_until_its_uavs_are_down(client: Client) -> None:
    mission = flown_mission(world(), MissionState.ABORTED)
    Mission.objects.filter(pk=mission.pk).update(ended_at=timezone.now())
    uav = a_uav()
    mission.mission_uavs.update(uav=uav)
    UavLink.objects.create(uav=uav, is_in_air=True, last_message_at=timezone.now())
    held = brought_in(client, zone_file(("Fire", 9.99), south=55.95))
    assert codes(held) == ["flown_missions"]
    UavLink.objects.filter(uav=uav).update(is_in_air=False)
    assert brought_in(client, zone_file(("Fire", 9.99), south=55.95))["state"] == "applied"


def test_a_zone_far_from_missions_that_are_flown_is_applied(client: Client) -> None:
    flown_mission(world())
    assert brought_in(client, zone_file(("Far", FAR)))["state"] == "applied"


def test_a_zone_that_is_moved_away_from_a_flown_mission_or_is_gone_is_a_change_about_it(client: Client) -> None:
    """Where it was counts as much as where it is to be."""
    mission = flown_mission(world(), MissionState.PLANNED)
    brought_in(client, zone_file(("Fire", 9.99), ("Far", FAR), south=55.95))
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.ACTIVE)
    assert codes(brought_in(client, zone_file(("Fire", FAR + 1), ("Far", FAR), south=55.95))) == ["flown_missions"]
    assert codes(brought_in(client, zone_file(("Far", FAR), south=55.95), max_removed_percent=100.0)) == ["flown_missions"]
    assert brought_in(client, zone_file(("Fire", 9.99), ("Far", FAR), south=55.95))["state"] == "applied"  # as it is: no change


def test_a_new_tower_at_a_flown_route_is_held_back_and_one_elsewhere_is_not(client: Client) -> None:
    flown_mission(world())
    assert codes(masts(client, ("New", *FLOWN))) == ["flown_missions"]
    assert masts(client, ("New", FLOWN[0], FLOWN[1] + 0.1))["state"] == "applied"
    assert codes(masts(client, ("New", *FLOWN))) == ["flown_missions"]  # it would come nearer


def test_a_target_of_a_flown_mission_that_a_file_changes_is_held_back_wherever_it_lies(client: Client) -> None:
    masts(client, *row_of_masts(20))
    mission = flown_mission(world())
    mission.targets.filter(sequence=0).update(asset=Asset.objects.get(ref="M3"))
    assert codes(masts(client, *row_of_masts(20), height_m=44.0)) == ["flown_missions"]
    assert codes(masts(client, *[row for row in row_of_masts(20) if row[0] != "M3"])) == ["flown_missions"]
    assert masts(client, *[row for row in row_of_masts(20) if row[0] != "M4"])["state"] == "applied"


def test_an_openstreetmap_file_that_changes_what_is_flown_is_held_back(client: Client, tmp_path: Path) -> None:
    nodes, ways = small_line()
    brought_in(client, write_osm(tmp_path / "a.osm", nodes, ways).read_bytes(), "osm", "a.osm")
    mission = flown_mission(world())
    mission.targets.filter(sequence=0).update(asset=Asset.objects.get(kind="tower", osm_id=2))
    lon, lat, tags = nodes[2]
    nodes[2] = (lon, lat, tags | {"ref": "two"})
    assert codes(brought_in(client, write_osm(tmp_path / "b.osm", nodes, ways).read_bytes(), "osm", "a.osm")) == ["flown_missions"]
    assert Asset.objects.get(kind="tower", osm_id=2).ref == ""


def test_changes_after_the_first_that_are_stored_are_looked_at(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pipeline, "MAX_CHANGES_KEPT", 1)
    flown_mission(world())
    assert codes(masts(client, *row_of_masts(50), ("Last", *FLOWN))) == ["flown_missions"]


def test_missions_of_other_organisations_hold_back_too_and_are_not_named(client: Client) -> None:
    mission = flown_mission(world())
    Mission.objects.filter(pk=mission.pk).update(organisation=Organisation.objects.create(name="Others"), name="Secret survey")
    held = masts(client, ("New", *FLOWN))
    assert codes(held) == ["flown_missions"]
    assert "Secret" not in json.dumps(held)


def test_a_curator_applies_what_was_held_back(client: Client) -> None:
    flown_mission(world())
    held = masts(client, ("New", *FLOWN))
    applying = client.post(f"/api/v1/imports/{held['id']}/apply", {}, content_type="application/json").json()
    apply_proposal(applying["job"]["id"])
    applied = client.get(f"/api/v1/imports/{held['id']}").json()
    assert (applied["state"], codes(applied)) == ("applied", ["flown_missions"])  # what somebody then decided to do all the same


def test_a_mission_that_takes_off_between_reading_and_applying_counts(client: Client) -> None:
    mission = flown_mission(world(), MissionState.APPROVED)
    proposal = asked(client, towers(("New", *FLOWN)), "assets", parameters=TOWERS).json()
    read_proposal(proposal["job"]["id"])
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.ACTIVE)
    assert codes(carried_on(client, proposal["id"])) == ["flown_missions"]


def test_one_whose_job_was_cancelled_waits_and_says_so(client: Client) -> None:
    proposal = asked(client, zone_file(("A", FAR))).json()
    read_proposal(proposal["job"]["id"])
    applying = client.get(f"/api/v1/imports/{proposal['id']}").json()
    client.post(f"/api/v1/jobs/{applying['job']['id']}/cancel")
    settle_proposals()
    held = client.get(f"/api/v1/imports/{proposal['id']}").json()
    cancelled = [{"code": "job_cancelled", "params": {}}]
    assert (held["state"], held["held_back"]) == ("ready", [{"code": "not_applied", "message": "Cancelled", "why": cancelled}])


def test_a_refused_file_stays_refused(client: Client) -> None:
    refused = brought_in(client, b"{}")
    assert (refused["state"], refused["held_back"]) == ("refused", [])


def test_terrain_is_never_applied_by_itself(client: Client) -> None:
    answer = asked(client, b"II*\0", "terrain", "heights.tif")
    assert (answer.status_code, list(answer.json()["error"]["details"])) == (400, ["auto_apply"])
    assert not Job.objects.exists()


@pytest.mark.parametrize("percent", [-1, 100.5, "many", "nan", True, None])
def test_a_bound_that_is_no_percentage_is_refused(client: Client, percent: Any) -> None:
    assert asked(client, zone_file(("A", FAR)), max_removed_percent=percent).status_code == 400


@pytest.mark.parametrize(("role", "scopes", "status"), [
    (Role.CURATOR, ("curate",), 202), (Role.CURATOR, ("read", "plan", "fly"), 403), (Role.OPERATOR, (), 403), (Role.VIEWER, (), 403),
])  # fmt: skip
def test_it_takes_the_scope_curate(role: Role, scopes: tuple[str, ...], status: int) -> None:
    user = a_user(role)
    assert asked(with_token(user, *scopes), zone_file(("A", FAR))).status_code == status


def work_through_the_queue() -> None:
    """What the data workers do, until nothing waits any more."""
    try:
        deadline = time.monotonic() + 20.0
        while time.monotonic() < deadline and not Job.objects.filter(task="inspection.tasks.apply_proposal", state="done").exists():
            for job in Job.objects.filter(state="queued"):
                (read_proposal if job.task.endswith("read_proposal") else apply_proposal)(str(job.pk))
            if ImportProposal.objects.exclude(held_back=[]).exists():
                return
            time.sleep(0.05)
    finally:
        connection.close()


@contextmanager
def a_worker() -> Iterator[None]:
    thread = threading.Thread(target=work_through_the_queue)
    thread.start()
    try:
        yield
    finally:
        thread.join()


@pytest.mark.django_db(transaction=True)
def test_the_command_applies_what_keeps_to_the_bounds_and_fails_with_the_reasons_otherwise(tmp_path: Path) -> None:
    path, out = tmp_path / "works.geojson", StringIO()
    path.write_bytes(zone_file(("A", FAR), ("B", FAR + 0.2)))
    with a_worker():
        call_command("import_zones", str(path), "--auto-apply", "--licence", "CC0", stdout=out)
    assert "2 new" in out.getvalue()
    assert ImportProposal.objects.get().data_import.licence == "CC0"
    Job.objects.all().delete()
    path.write_bytes(zone_file(("A", FAR)))
    with a_worker(), pytest.raises(CommandError, match=r"is not applied, it is ready(?s:.)*It removes 1 of 2 rows of its source, 50 %"):
        call_command("import_zones", str(path), "--auto-apply", "--max-removed-percent", "10")
    assert NoFlyZone.objects.count() == 2


@pytest.mark.parametrize("options", [["--synthetic"], ["--max-removed-percent", "101"]])
def test_the_command_refuses_options_that_do_not_go_together(tmp_path: Path, options: list[str]) -> None:
    path = tmp_path / "works.geojson"
    path.write_bytes(zone_file(("A", FAR)))
    with pytest.raises(CommandError):
        call_command("import_zones", str(path), "--auto-apply", *options)
    assert not ImportProposal.objects.exists()
