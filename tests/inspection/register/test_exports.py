"""GeoPackages that a job writes: offered to their user alone, stopped, and only the newest kept."""

import sqlite3
from pathlib import Path
from typing import Any
from uuid import uuid4

import pytest
from django.test import Client

from inspection.models import Upload
from inspection.services import exports
from inspection.services.exports import EXPORT_TASK, MAX_KEPT, MAX_OPEN
from inspection.tasks import export_register
from inspection.views import export_files
from tests.accounts.users import a_user, client_of
from tests.inspection.ground import tower, zone
from workspace.models import Job, JobState, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture(autouse=True)
def queue(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("workspace.tasks.send_job", lambda job: None)


@pytest.fixture
def user() -> User:
    return a_user(Role.VIEWER)


@pytest.fixture
def client(user: User) -> Client:
    return client_of(user)


def starts(client: Client, path: str = "assets/exports") -> Any:
    return client.post(f"/api/v1/{path}")


def written(client: Client, path: str = "assets/exports") -> str:
    answer = starts(client, path)
    assert answer.status_code == 202, answer.content
    export_register(answer.json()["id"])
    return str(answer.json()["id"])


def test_a_job_writes_what_is_filtered_and_offers_it(client: Client, tmp_path: Path) -> None:
    for operator in ("Nordnet", "Nordnet", "Other"):
        tower(operator=operator)
    answer = starts(client, "assets/exports?operator=Nordnet&inspected_before=2020-01-01T00:00:00Z")
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "nothing_found")
    answer = starts(client, "assets/exports?operator=Nordnet&kind=tower,line")
    job = answer.json()["id"]
    assert (answer.status_code, answer["Location"]) == (202, f"/api/v1/jobs/{job}")
    assert client.get(f"/api/v1/exports/{job}").json()["error"]["code"] == "not_ready"
    export_register(job)
    told = client.get(answer["Location"]).json()
    assert (told["state"], told["result"]["file_name"]) == ("done", "assets.gpkg")
    file = client.get(f"/api/v1/exports/{job}")
    content = b"".join(file.streaming_content)
    assert len(content) == told["result"]["size_bytes"] == int(file["Content-Length"])
    path = tmp_path / "assets.gpkg"
    path.write_bytes(content)
    with sqlite3.connect(path) as database:
        assert database.execute("SELECT operator FROM towers").fetchall() == [("Nordnet",)] * 2


def test_filters_with_a_time_and_a_box_reach_the_job(client: Client) -> None:
    zone()
    job = written(client, "zones/exports?active_at=2026-11-29T12:00:00Z&bbox=9,55,11,57")
    assert Job.objects.get(pk=job).state == JobState.DONE
    tower()
    job = written(client, "assets/exports?inspected=false&bbox=9,55,11,57")
    assert Job.objects.get(pk=job).state == JobState.DONE


def test_the_file_is_its_users_alone(client: Client) -> None:
    tower()
    job = written(client)
    for other in (a_user(Role.ADMINISTRATOR), a_user(Role.CURATOR)):
        assert client_of(other).get(f"/api/v1/exports/{job}").status_code == 404
        assert client_of(other).delete(f"/api/v1/exports/{job}").status_code == 404
    assert client.get(f"/api/v1/exports/{job}").status_code == 200
    assert client.get(f"/api/v1/exports/{uuid4()}").status_code == 404


def test_an_export_is_stopped_before_and_while_it_is_written(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    tower()
    job = starts(client).json()["id"]
    assert client.delete(f"/api/v1/exports/{job}").status_code == 204
    export_register(job)
    assert (Job.objects.get(pk=job).state, Upload.objects.count()) == (JobState.CANCELLED, 0)
    job = starts(client).json()["id"]
    rows_of = exports.asset_rows

    def stopped(wanted: Any) -> Any:
        yield from rows_of(wanted)
        client.delete(f"/api/v1/exports/{job}")

    monkeypatch.setitem(exports._WRITERS, "assets", (exports.AssetFilter, stopped, exports.ASSET_COLUMNS))
    export_register(job)
    assert (Job.objects.get(pk=job).state, Upload.objects.count()) == (JobState.CANCELLED, 0)


def test_the_last_files_of_a_user_are_kept(client: Client) -> None:
    tower()
    jobs = [written(client) for _ in range(MAX_KEPT + 1)]
    assert client.get(f"/api/v1/exports/{jobs[0]}").status_code == 404
    assert Upload.objects.count() == MAX_KEPT


def test_enough_jobs_of_a_user_are_enough(client: Client, user: User) -> None:
    tower()
    for _ in range(MAX_OPEN):
        Job.objects.create(organisation=user.organisation, created_by=user, task=EXPORT_TASK)
    assert starts(client).status_code == 429


def test_a_large_geopackage_is_not_written_while_the_request_waits(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(export_files, "MAX_DIRECT", 1)
    for add, path in ((tower, "assets"), (zone, "zones")):
        add()
        add()
        assert client.get(f"/api/v1/{path}/export.gpkg").json()["error"]["code"] == "too_many"
        assert client.get(f"/api/v1/{path}/export.csv").status_code == 200
        assert starts(client, f"{path}/exports").status_code == 202
