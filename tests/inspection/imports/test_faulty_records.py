"""Zone files with faulty records: each is listed and drawn, the rest counts once a curator has seen them, and nothing vanishes for it."""

from pathlib import Path
from typing import Any

import pytest

from inspection.models import ImportProposal, NoFlyZone
from inspection.services import import_zones
from inspection.services.imports.uploads import store_upload
from inspection.services.proposals import pipeline
from inspection.tasks import apply_proposal, read_proposal
from tests.accounts.users import client_of
from tests.inspection.imports.zone_sets import zone_file
from workspace.models import User

pytestmark = pytest.mark.django_db

SQUARE = "DP 47:00:00 N 00{0}:00:00 E\nDP 47:10:00 N 00{0}:00:00 E\nDP 47:10:00 N 00{0}:10:00 E\nDP 47:00:00 N 00{0}:10:00 E\n"


def openair(folder: Path, *records: tuple[str, str]) -> Path:
    path = folder / "National.txt"
    path.write_text("".join(f"AC R\nAN {name}\n{border}" for name, border in records))
    return path


def broken(border: str) -> str:
    return border.replace("47:10:00", "47:10:77", 1)


def proposed(path: Path, curator: User, **parameters: Any) -> ImportProposal:
    upload = store_upload(file_name=path.name, chunks=[path.read_bytes()], created_by=curator)
    proposal = pipeline.start_proposal(
        kind="zones",
        upload=upload,
        file_name=path.name,
        parameters={"set_name": "National"} | parameters,
        provenance={},
        created_by=curator,
    )
    read_proposal(str(proposal.job_id))
    proposal.refresh_from_db()
    return proposal


def applied(proposal: ImportProposal, curator: User, **parameters: Any) -> ImportProposal:
    pipeline.ask_to_apply(proposal=proposal, parameters=parameters, actor=curator)
    proposal.refresh_from_db()
    apply_proposal(str(proposal.job_id))
    proposal.refresh_from_db()
    return proposal


def test_a_faulty_record_is_listed_and_drawn_and_the_rest_applied_once_it_was_seen(tmp_path: Path, curator: User) -> None:
    path = openair(tmp_path, ("West", SQUARE.format(7)), ("East", broken(SQUARE.format(8))))
    assert proposed(path, curator).state == "refused"
    proposal = proposed(path, curator, leave_out_faulty=True)
    assert (proposal.state, proposal.difference["new"], proposal.difference["not_read"]) == ("ready", 1, 1)
    (record,) = proposal.summary["not_read"]
    assert (record["name"], record["place"], record["message"]) == ("East", "line 10", "minutes and seconds are at most 60")
    change = proposal.changes.get(action="not_read")
    assert change.geometry is not None
    assert change.geometry.extent == pytest.approx((8.0, 47.0, 8 + 10 / 60, 47 + 10 / 60), abs=0.001)
    for seen in ({}, {"seen": []}, {"seen": ["line 3"]}, {"seen": "line 10"}):
        with pytest.raises(pipeline.NotSeen) as refused:
            pipeline.ask_to_apply(proposal=proposal, parameters=seen, actor=curator)
        assert refused.value.places == ["line 10"]
    done = applied(proposal, curator, seen=["line 10"])
    assert done.state == "applied"
    assert [zone.name for zone in NoFlyZone.objects.all()] == ["West"]
    assert done.data_import is not None
    assert done.data_import.counts["not_read"] == proposal.summary["not_read"]  # kept with the version


def test_a_zone_whose_new_record_is_faulty_stays_until_a_version_can_be_read(tmp_path: Path, curator: User) -> None:
    import_zones(
        path=openair(tmp_path, ("West", SQUARE.format(7)), ("East", SQUARE.format(8)), ("Old", SQUARE.format(6))), set_name="National"
    )
    was = NoFlyZone.objects.get(name="East")
    path = openair(tmp_path, ("West", SQUARE.format(7)), ("East", broken(SQUARE.format(8))), ("North", SQUARE.format(9)))
    proposal = proposed(path, curator, leave_out_faulty=True)
    assert {action: proposal.difference[action] for action in ("new", "vanished", "not_read")} == {"new": 1, "vanished": 1, "not_read": 1}
    applied(proposal, curator, seen=["line 10"])
    assert sorted(zone.name for zone in NoFlyZone.objects.all()) == ["East", "North", "West"]
    assert NoFlyZone.objects.get(name="East").geometry.equals_exact(was.geometry)
    repaired = proposed(openair(tmp_path, ("West", SQUARE.format(7)), ("East", SQUARE.format(5)), ("North", SQUARE.format(9))), curator)
    assert (repaired.difference["changed"], repaired.difference["vanished"]) == (1, 0)


def test_a_faulty_zone_of_a_json_file_is_left_out_with_its_box(tmp_path: Path, curator: User) -> None:
    path = tmp_path / "National.geojson"
    path.write_bytes(zone_file(("West", 7.0), ("East", 8.0)).replace(b'"name": "East"', b'"name": "East", "restriction": []'))
    proposal = proposed(path, curator, leave_out_faulty=True)
    assert (proposal.state, proposal.difference["new"], proposal.difference["not_read"]) == ("ready", 1, 1)
    assert proposal.changes.get(action="not_read").geometry is not None
    assert proposal.summary["not_read"][0]["name"] == "East"


def test_the_api_names_the_records_that_nobody_has_seen(tmp_path: Path, curator: User) -> None:
    proposal = proposed(openair(tmp_path, ("West", SQUARE.format(7)), ("East", broken(SQUARE.format(8)))), curator, leave_out_faulty=True)
    address, client = f"/api/v1/imports/{proposal.pk}/apply", client_of(curator)
    refused = client.post(address, {"parameters": {"seen": ["line 4"]}}, content_type="application/json")
    assert (refused.status_code, refused.json()["error"]["code"]) == (409, "not_seen")
    assert refused.json()["error"]["details"]["places"] == ["line 10"]
    accepted = client.post(address, {"parameters": {"seen": ["line 10"]}}, content_type="application/json")
    assert (accepted.status_code, accepted.json()["state"]) == (202, "applying")
    assert client.get(f"/api/v1/imports/{proposal.pk}/changes?action=not_read").json()["features"][0]["geometry"]["type"] == "Polygon"


def test_of_several_zones_of_one_name_none_takes_the_place_of_another_that_cannot_be_read(tmp_path: Path, curator: User) -> None:
    three = [("ED-R 12", SQUARE.format(degree)) for degree in (6, 7, 8)]
    import_zones(path=openair(tmp_path, *three), set_name="National")
    was = {zone.pk: zone.geometry.extent for zone in NoFlyZone.objects.all()}
    path = openair(tmp_path, three[0], ("ED-R 12", broken(SQUARE.format(7))), three[2], ("ED-R 12", SQUARE.format(9)))
    proposal = proposed(path, curator, leave_out_faulty=True)
    assert {action: proposal.difference[action] for action in ("new", "changed", "vanished", "unchanged")} == {
        "new": 1, "changed": 0, "vanished": 0, "unchanged": 2,
    }  # fmt: skip
    applied(proposal, curator, seen=[record["place"] for record in proposal.summary["not_read"]])
    assert {zone.pk: zone.geometry.extent for zone in NoFlyZone.objects.filter(pk__in=was)} == was
    assert NoFlyZone.objects.count() == 4
