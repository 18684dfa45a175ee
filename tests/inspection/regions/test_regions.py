"""A region is deleted as a whole, and a file restores it."""

from collections.abc import Callable
from io import StringIO
from pathlib import Path

import pytest
from django.core.management import call_command
from django.core.management.base import CommandError
from django.test import Client

from inspection.models import Asset
from inspection.selectors import ground_revision
from inspection.services import import_osm
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import line, tower
from workspace.models import AuditEntry, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.CURATOR))


def delete(client: Client, **body: object):
    return client.post("/api/v1/regions/delete", body, content_type="application/json")


def on_the_ground() -> int:
    return Asset.objects.filter(vanished_at=None).count()


def test_a_box_is_counted_first_and_then_deleted(client: Client) -> None:
    tower((10.0, 56.0))
    tower((12.0, 56.0))
    line((9.0, 56.0), (10.05, 56.05))
    box = [9.95, 55.95, 10.1, 56.1]
    assert delete(client, bbox=box, dry_run=True).json() == {"counts": {"tower": 1, "line": 1}}
    assert on_the_ground() == 3
    revision = ground_revision()
    assert delete(client, bbox=box).json() == {"counts": {"tower": 1, "line": 1}}
    assert (on_the_ground(), ground_revision()) == (1, revision + 1)
    entry = AuditEntry.objects.get()
    assert (entry.subject_type, entry.before["bbox"], entry.before["counts"]) == ("region", box, {"tower": 1, "line": 1})
    assert delete(client, bbox=box).json() == {"counts": {}}


@pytest.mark.parametrize("name", ["quillmoor.osm.pbf", "liechtenstein-2021-infra.osm.pbf"])
def test_an_import_is_deleted_and_its_file_restores_everything(name: str, client: Client, region_file: Callable[[str], Path]) -> None:
    file = region_file(name)
    first = import_osm(path=file)
    all_of_it = on_the_ground()
    assert sum(delete(client, import_id=first.pk).json()["counts"].values()) == all_of_it
    assert on_the_ground() == 0
    assert import_osm(path=file).counts["changed"] == all_of_it
    assert on_the_ground() == all_of_it


@pytest.mark.parametrize(
    "body", [{}, {"bbox": [1, 2, 3]}, {"bbox": [0, 10, 1, 9]}, {"import_id": 7}, {"set": "none"}, {"bbox": [0, 0, 1, 1], "set": "x"}]
)
def test_a_region_that_is_none_is_refused(client: Client, body: dict[str, object]) -> None:
    assert delete(client, **body).status_code == 400


def test_operators_delete_no_region() -> None:
    assert delete(client_of(a_user(Role.OPERATOR)), bbox=[0, 0, 1, 1]).status_code == 403


def test_the_command_counts_before_it_deletes() -> None:
    tower((10.0, 56.0))
    reported = StringIO()
    call_command("delete_region", "--bbox=9,55,11,57", stdout=reported)
    assert (reported.getvalue(), on_the_ground()) == ("1 tower would be deleted; --yes deletes\n", 1)
    call_command("delete_region", "--bbox=9,55,11,57", "--yes", stdout=reported)
    assert (reported.getvalue().splitlines()[-1], on_the_ground()) == ("1 tower deleted", 0)
    with pytest.raises(CommandError, match="four numbers"):
        call_command("delete_region", "--bbox=here")
