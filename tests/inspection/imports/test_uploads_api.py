"""Files come in part by part: cut connections go on where they were, and nothing stays that nobody needs."""

import hashlib
from datetime import timedelta
from typing import Any

import pytest
from django.test import Client
from django.utils import timezone

from inspection.models import Upload, UploadPart
from inspection.services.imports.uploads import (
    PART_BYTES,
    UploadRefused,
    forget_old_uploads,
    plain_name,
    store_upload,
    upload_as_file,
    upload_folder,
)
from tests.accounts.users import a_user, client_of
from workspace.models import Organisation, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user(Role.CURATOR))


def begin(client: Client, size_bytes: int, file_name: str = "zones.json"):
    return client.post("/api/v1/uploads", {"file_name": file_name, "size_bytes": size_bytes}, content_type="application/json")


def send(client: Client, upload: str, first_byte: int, content: bytes):
    return client.put(f"/api/v1/uploads/{upload}/bytes/{first_byte}", content, content_type="application/octet-stream")


def test_files_of_one_organisation_take_no_more_room_than_they_may(client: Client, settings: Any) -> None:
    settings.UPLOADS_BYTES = 1_000
    first = begin(client, 600).json()["id"]
    refused = begin(client_of(a_user(Role.CURATOR)), 401)
    assert (refused.status_code, refused.json()["error"]["code"]) == (409, "too_many_uploads")
    assert begin(client, 400).status_code == 201
    other = client_of(a_user(Role.CURATOR, Organisation.objects.create(name="Other")))
    assert begin(other, 1_000).status_code == 201
    assert client.delete(f"/api/v1/uploads/{first}").status_code == 204
    assert begin(client, 600).status_code == 201


def test_a_file_arrives_whole_in_parts(client: Client) -> None:
    whole = bytes(range(256)) * 6_000  # 1.5 parts
    upload = begin(client, len(whole)).json()
    assert (upload["received_bytes"], upload["is_complete"], upload["part_bytes"]) == (0, False, PART_BYTES)
    assert send(client, upload["id"], 0, whole[:PART_BYTES]).json()["received_bytes"] == PART_BYTES
    answer = send(client, upload["id"], PART_BYTES, whole[PART_BYTES:]).json()
    assert answer["is_complete"]
    stored = Upload.objects.get()
    assert stored.sha256 == hashlib.sha256(whole).hexdigest()
    with upload_as_file(stored) as path:
        assert path.read_bytes() == whole
        assert path.stat().st_mode & 0o077 == 0 or path.parent.stat().st_mode & 0o077 == 0
    assert not path.parent.exists()


def test_a_cut_connection_goes_on_where_it_was(client: Client) -> None:
    upload = begin(client, 10).json()["id"]
    send(client, upload, 0, b"01234")
    assert send(client, upload, 0, b"01234").status_code == 200  # its answer was lost
    gap = send(client, upload, 7, b"789")
    assert (gap.status_code, gap.json()["error"]["code"]) == (409, "gap")
    assert client.get(f"/api/v1/uploads/{upload}").json()["received_bytes"] == 5
    assert send(client, upload, 5, b"56789").json()["is_complete"]
    assert UploadPart.objects.count() == 2


@pytest.mark.parametrize(("first_byte", "content"), [(0, b"x" * 11), (5, b"x" * 6), (0, b"")])
def test_bytes_that_do_not_fit_are_refused(client: Client, first_byte: int, content: bytes) -> None:
    upload = begin(client, 10).json()["id"]
    assert send(client, upload, first_byte, content).status_code in {400, 409}
    assert UploadPart.objects.count() == 0


def test_a_part_that_is_too_large_is_refused(client: Client) -> None:
    upload = begin(client, 10 * PART_BYTES).json()["id"]
    assert send(client, upload, 0, b"x" * (PART_BYTES + 1)).status_code == 400
    assert send(client, upload, 0, b"x" * (3 * PART_BYTES)).status_code == 413


def test_a_file_over_the_limit_is_refused_before_a_byte_is_sent(client: Client, settings: Any) -> None:
    settings.MAX_UPLOAD_BYTES = dict.fromkeys(settings.MAX_UPLOAD_BYTES, 1024 * 1024)
    answer = begin(client, 1024 * 1024 + 1)
    assert answer.status_code == 413
    assert "at most 1 MiB" in answer.json()["error"]["message"]
    assert begin(client, 0).status_code == 400


@pytest.mark.parametrize("role", [Role.VIEWER, Role.OPERATOR])
def test_only_curators_send_files(client: Client, role: Role) -> None:
    upload = begin(client, 5).json()["id"]
    other = client_of(a_user(role))
    assert begin(other, 5).status_code == 403
    assert send(other, upload, 0, b"01234").status_code == 403
    assert other.get(f"/api/v1/uploads/{upload}").status_code == 403


@pytest.mark.parametrize(
    ("given", "kept"),
    [("../../etc/passwd", "passwd"), ("C:\\data\\zones.json", "zones.json"), ("\x00.\x1b[31m", "[31m"), ("", "file"), ("...", "file")],
)
def test_a_name_is_no_way_out_of_the_folder(given: str, kept: str) -> None:
    assert plain_name(given) == kept


def test_a_file_that_has_not_arrived_whole_or_was_damaged_is_not_read() -> None:
    upload = store_upload(file_name="zones.json", chunks=[b"01234", b"56789"], created_by=None)
    UploadPart.objects.update(content=b"x123456789")
    with pytest.raises(UploadRefused, match="damaged"), upload_as_file(upload):
        pass
    upload.received_bytes = 5
    with pytest.raises(UploadRefused, match="whole"), upload_as_file(upload):
        pass
    assert list(upload_folder().glob("spanwise-upload-*")) == []


def test_what_nobody_went_on_with_is_forgotten_after_a_day() -> None:
    old, new = (store_upload(file_name="a", chunks=[b"1"], created_by=None) for _ in range(2))
    Upload.objects.filter(pk=old.pk).update(updated_at=timezone.now() - timedelta(hours=25))
    forget_old_uploads()
    assert [upload.pk for upload in Upload.objects.all()] == [new.pk]


def test_each_kind_has_its_own_limit(client: Client, settings: Any) -> None:
    settings.MAX_UPLOAD_BYTES = settings.MAX_UPLOAD_BYTES | {"zones": 4}
    upload = store_upload(file_name="zones.json", chunks=[b"01234"], created_by=None)
    answer = client.post("/api/v1/imports", {"kind": "zones", "upload": str(upload.pk)}, content_type="application/json")
    assert answer.status_code == 413
    assert not upload.proposals.exists()


def test_a_file_that_somebody_still_decides_on_cannot_be_deleted_and_one_that_is_decided_on_is_forgotten(client: Client) -> None:
    upload = store_upload(file_name="zones.json", chunks=[b"{}"], created_by=None)
    body = {"kind": "zones", "upload": str(upload.pk)}
    proposal = client.post("/api/v1/imports", body, content_type="application/json").json()["id"]
    assert client.delete(f"/api/v1/uploads/{upload.pk}").status_code == 409
    forget_old_uploads()
    assert Upload.objects.exists()
    client.post(f"/api/v1/imports/{proposal}/discard")
    forget_old_uploads()
    assert not Upload.objects.exists()
    assert not UploadPart.objects.exists()


def test_what_a_killed_reader_left_goes_with_the_next_file_and_what_somebody_reads_stays() -> None:
    upload = store_upload(file_name="zones.json", chunks=[b"{}"], created_by=None)
    left = upload_folder() / "spanwise-upload-of-a-killed-one"
    left.mkdir()
    (left / "zones.json").write_bytes(b"{}")
    with upload_as_file(upload) as one:
        assert not left.exists()
        with upload_as_file(upload) as other:
            assert one.exists()
            assert other.exists()
