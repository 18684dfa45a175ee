"""Two organisations work on common ground: each reads the names of its own people alone, installation operators read all."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from django.test import Client
from django.utils import timezone

from inspection.models import DataImport, DataIssue, ImportProposal, NoFlyZone
from inspection.services import find_issues, save_zone
from inspection.services.data_issues import dismiss_issue
from tests.accounts.users import a_user, client_of
from tests.inspection import ground
from tests.inspection.imports.zone_sets import SETS, stored
from workspace.models import Organisation, Role, User

pytestmark = pytest.mark.django_db
OTHERS = "another organisation"


@pytest.fixture
def neighbour() -> User:
    return a_user(Role.CURATOR, Organisation.objects.create(name="Neighbours"))


@pytest.fixture
def zone(neighbour: User) -> NoFlyZone:
    zone = ground.zone((10.0, 56.0), 0.01, name="Works")
    zone.reason = "Crane"
    save_zone(zone=zone, actor=neighbour)
    return zone


def operator() -> User:
    user = a_user(Role.ADMINISTRATOR)
    user.is_installation_operator = True
    user.save()
    return user


def in_the_history(_: User, folder: Path) -> Callable[[Client], Any]:
    return lambda client: client.get("/api/v1/history").json()["results"][0]["actor"]


def in_the_history_of_a_zone(_: User, folder: Path) -> Callable[[Client], Any]:
    zone = NoFlyZone.objects.get()
    return lambda client: client.get(f"/api/v1/zones/{zone.pk}/history").json()["results"][0]["actor"]


def in_a_refusal_of_an_old_revision(_: User, folder: Path) -> Callable[[Client], Any]:
    zone = NoFlyZone.objects.get()

    def changed_by(client: Client) -> Any:
        answer = client.patch(f"/api/v1/zones/{zone.pk}", {"name": "A"}, content_type="application/json", headers={"If-Match": '"0"'})
        assert answer.status_code == 412
        error = answer.json()["error"]
        assert error["details"]["changed_by"] in error["message"]
        return error["details"]["changed_by"]

    return changed_by


def at_the_source_of_a_set(neighbour: User, folder: Path) -> Callable[[Client], Any]:
    stored(folder, ("A", 9.0), imported_by=neighbour)
    return lambda client: client.get(SETS).json()["results"][0]["source"]["imported_by"]


def at_a_version_of_a_set(neighbour: User, folder: Path) -> Callable[[Client], Any]:
    stored(folder, ("A", 9.0), imported_by=neighbour)
    address = f"{SETS}/{DataImport.objects.get().zone_sets.get().pk}/versions"
    return lambda client: client.get(address).json()["results"][0]["created_by"]


def _proposal(neighbour: User, **facts: Any) -> ImportProposal:
    return ImportProposal.objects.create(kind="zones", file_name="A.geojson", created_by=neighbour, **facts)


def at_an_import(neighbour: User, folder: Path) -> Callable[[Client], Any]:
    _proposal(neighbour)
    return lambda client: client.get("/api/v1/imports").json()["results"][0]["created_by"]


def in_a_refusal_of_a_decided_import(neighbour: User, folder: Path) -> Callable[[Client], Any]:
    proposal = _proposal(neighbour, state="applied", decided_by=neighbour, decided_at=timezone.now())
    address = f"/api/v1/imports/{proposal.pk}/discard"
    return lambda client: client.post(address, {}, content_type="application/json").json()["error"]["details"]["decided_by"]


def at_a_data_issue(neighbour: User, folder: Path) -> Callable[[Client], Any]:
    ground.tower((10.0, 56.0))
    ground.tower((10.004, 56.0))
    ground.line((10.0, 56.0), (10.004, 56.0), (10.04, 56.0))
    find_issues()
    dismiss_issue(issue=DataIssue.objects.all()[0], note="", actor=neighbour)
    return lambda client: client.get("/api/v1/data-issues?state=dismissed").json()["features"][0]["properties"]["decided_by"]


PLACES = [
    in_the_history,
    in_the_history_of_a_zone,
    in_a_refusal_of_an_old_revision,
    at_the_source_of_a_set,
    at_a_version_of_a_set,
    at_an_import,
    in_a_refusal_of_a_decided_import,
    at_a_data_issue,
]


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.usefixtures("zone")
def test_a_name_is_read_within_its_organisation_and_by_installation_operators(place: Any, neighbour: User, tmp_path: Path) -> None:
    name_for = place(neighbour, tmp_path)
    colleague = a_user(Role.CURATOR, neighbour.organisation)
    assert name_for(client_of(colleague)) == neighbour.username
    assert name_for(client_of(operator())) == neighbour.username
    assert name_for(client_of(a_user(Role.ADMINISTRATOR))) == OTHERS


@pytest.mark.usefixtures("zone")
def test_the_words_are_in_the_readers_language() -> None:
    answer = client_of(a_user(Role.CURATOR)).get("/api/v1/history", headers={"Accept-Language": "de"})
    assert answer.json()["results"][0]["actor"] == "jemand aus einer anderen Organisation"


@pytest.mark.usefixtures("zone")
def test_a_history_cannot_be_searched_for_people_of_others(neighbour: User) -> None:
    def changes_by(name: str, reader: User) -> int:
        return len(client_of(reader).get("/api/v1/history", {"actor": name}).json()["results"])

    reader = a_user(Role.ADMINISTRATOR)
    assert changes_by(neighbour.username, reader) == changes_by("nobody", reader) == 0
    assert changes_by(neighbour.username, a_user(Role.CURATOR, neighbour.organisation)) == 1
    assert changes_by(neighbour.username, operator()) == 1


def test_the_admin_names_people_of_others_to_installation_operators_alone(neighbour: User, zone: NoFlyZone, tmp_path: Path) -> None:
    stored(tmp_path, ("A", 9.0), imported_by=neighbour)
    proposal = _proposal(neighbour, state="applied", decided_by=neighbour, decided_at=timezone.now())
    pages = [
        f"noflyzone/{zone.pk}/history/",
        "dataimport/",
        f"dataimport/{DataImport.objects.get().pk}/change/",
        "importproposal/",
        f"importproposal/{proposal.pk}/change/",
        "zonesetversion/",
    ]

    def shown_to(user: User, page: str) -> str:
        answer = client_of(user).get(f"/admin/inspection/{page}")
        assert answer.status_code == 200, page
        return answer.content.decode()

    outsider, knowing = a_user(Role.ADMINISTRATOR), operator()
    assert not [page for page in pages if neighbour.username in shown_to(outsider, page)]
    assert not [page for page in pages[:-1] if neighbour.username not in shown_to(knowing, page)]
    assert f"by {OTHERS}" in shown_to(outsider, pages[0])
    found = client_of(outsider).get("/admin/inspection/importproposal/", {"q": neighbour.username}).content.decode()
    assert "A.geojson" not in found


def test_the_admin_tells_no_name_of_others_to_whom_came_too_late(neighbour: User, zone: NoFlyZone) -> None:
    address, outsider = f"/admin/inspection/noflyzone/{zone.pk}/change/", client_of(a_user(Role.ADMINISTRATOR))
    page = outsider.post(address, {"name": "A", "expected_revision": 0}).content.decode()
    assert f"{OTHERS} has changed this in the meantime" in page
    assert neighbour.username not in page
