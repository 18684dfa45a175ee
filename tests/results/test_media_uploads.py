"""Photos arrive whole and once: parts, cut connections, wrong hashes, room, and clients of the tus protocol."""

import errno
import os
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from django.db import connection
from django.test import Client
from django.utils import timezone
from tusclient.client import TusClient

from results.models import MediaUpload, Medium
from results.services import uploads
from results.services.uploads import PART_BYTES, forget_old_uploads, part_path, plain_name
from tests.accounts.users import a_user, client_of
from tests.results.photos import dji_photo, file_of, picture
from tests.results.sending import UPLOADS, begin, send, sha256_of, upload
from workspace.api_tokens import create_api_token
from workspace.models import Organisation, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user())


def large_photo() -> bytes:
    return dji_photo() + os.urandom(PART_BYTES + 5_000)  # such as a preview behind it


def test_a_photo_arrives_in_parts_and_is_stored_by_its_hash(client: Client, media_folder: Path) -> None:
    content = large_photo()
    begun = begin(client, content).json()
    assert (begun["received_bytes"], begun["part_bytes"], begun["is_known"]) == (0, PART_BYTES, False)
    first = send(client, begun["id"], 0, content[:PART_BYTES])
    assert (first.status_code, first["Upload-Offset"]) == (204, str(PART_BYTES))
    assert Medium.objects.count() == 0
    assert send(client, begun["id"], PART_BYTES, content[PART_BYTES:]).status_code == 204
    medium = Medium.objects.get()
    assert (medium.sha256, medium.size_bytes, medium.media_type) == (sha256_of(content), len(content), "image/jpeg")
    assert (media_folder / f"1/originals/{medium.sha256[:2]}/{medium.sha256}").read_bytes() == content
    assert client.get(f"{UPLOADS}/{begun['id']}").json()["medium"] == str(medium.pk)
    assert not part_path(MediaUpload.objects.get()).exists()


def test_after_a_cut_it_continues_where_it_was(client: Client) -> None:
    content = large_photo()
    key = begin(client, content).json()["id"]
    send(client, key, 0, content[:1_000])
    head = client.head(f"{UPLOADS}/{key}")
    assert (head["Upload-Offset"], head["Upload-Length"], head["Cache-Control"]) == ("1000", str(len(content)), "no-store")
    for offset in (0, 2_000):
        refused = send(client, key, offset, content[offset : offset + 100])
        assert (refused.status_code, refused.json()["error"]["code"], refused.json()["error"]["details"]) == (
            409, "offset", {"received_bytes": 1_000}
        )  # fmt: skip
    send(client, key, 1_000, content[1_000:PART_BYTES])
    send(client, key, PART_BYTES, content[PART_BYTES:])
    assert Medium.objects.get().sha256 == sha256_of(content)


def test_bytes_that_were_written_without_being_committed_are_written_again(client: Client) -> None:
    content = large_photo()
    key = begin(client, content).json()["id"]
    send(client, key, 0, content[:1_000])
    with part_path(MediaUpload.objects.get()).open("ab") as file:
        file.write(b"of a program that was killed")
    send(client, key, 1_000, content[1_000:PART_BYTES])
    send(client, key, PART_BYTES, content[PART_BYTES:])
    assert Medium.objects.get().sha256 == sha256_of(content)


def test_bytes_that_the_disk_has_lost_are_asked_for_again(client: Client) -> None:
    content = large_photo()
    key = begin(client, content).json()["id"]
    send(client, key, 0, content[:1_000])
    os.truncate(part_path(MediaUpload.objects.get()), 400)
    assert send(client, key, 1_000, b"x").status_code == 409
    send(client, key, 400, content[400:PART_BYTES])
    send(client, key, PART_BYTES, content[PART_BYTES:])
    assert Medium.objects.get().sha256 == sha256_of(content)


def test_another_hash_than_the_announced_is_refused_and_the_upload_begins_again(client: Client, media_folder: Path) -> None:
    content = dji_photo()
    key = begin(client, content).json()["id"]
    damaged = content[:-1] + b"x"
    refused = send(client, key, 0, damaged)
    assert (refused.status_code, refused.json()["error"]["code"]) == (422, "wrong_hash")
    assert Medium.objects.count() == 0 and not media_folder.exists()
    assert client.get(f"{UPLOADS}/{key}").json()["received_bytes"] == 0
    assert send(client, key, 0, content).status_code == 204
    assert Medium.objects.get().sha256 == sha256_of(content)


def test_what_is_known_need_not_be_sent(client: Client) -> None:
    content = dji_photo()
    medium = upload(client, content)
    again = begin(client, content, "copy.jpg")
    assert (again.status_code, again.json()["is_known"], again.json()["medium"]) == (200, True, str(medium.pk))
    asked = {"sha256": [sha256_of(content), "0" * 64]}
    known = client.post("/api/v1/media/lookup", asked, content_type="application/json").json()["known"]
    assert [one["id"] for one in known] == [str(medium.pk)]


def test_a_file_that_was_begun_before_is_continued(client: Client) -> None:
    content = dji_photo()
    key = begin(client, content).json()["id"]
    send(client, key, 0, content[:100])
    again = begin(client, content)
    assert (again.status_code, again.json()["id"], again.json()["received_bytes"]) == (200, key, 100)
    assert begin(client_of(a_user()), content).json()["id"] != key


def test_sent_twice_at_once_a_file_is_stored_once() -> None:
    content = dji_photo()
    clients = [client_of(a_user()) for _ in range(2)]
    keys = [begin(one, content).json()["id"] for one in clients]
    assert [send(one, key, 0, content).status_code for one, key in zip(clients, keys, strict=True)] == [204, 204]
    assert Medium.objects.get().uploads.count() == 2


def test_another_organisation_learns_nothing_from_a_hash_and_has_its_own_copy(client: Client, media_folder: Path) -> None:
    content = dji_photo()
    upload(client, content)
    home = Organisation.objects.create(name="Other")
    other = client_of(a_user(organisation=home))
    assert other.post("/api/v1/media/lookup", {"sha256": [sha256_of(content)]}, content_type="application/json").json() == {"known": []}
    upload(other, content)
    assert {path.name for path in media_folder.iterdir()} == {"1", str(home.pk)}


def test_media_take_no_more_room_than_they_may(client: Client, settings: Any) -> None:
    content = dji_photo()
    settings.MEDIA_BYTES = len(content) + 500
    key = begin(client, content).json()["id"]
    refused = begin(client, b"x" * 501)
    assert (refused.status_code, refused.json()["error"]["code"]) == (409, "no_room")
    assert "Delete some" in refused.json()["error"]["message"]
    assert client.get("/api/v1/media/use").json() == {"used_bytes": len(content), "max_bytes": len(content) + 500}
    assert begin(client_of(a_user(organisation=Organisation.objects.create(name="Other"))), b"x" * 501).status_code == 201
    assert client.delete(f"{UPLOADS}/{key}").status_code == 204
    assert begin(client, b"x" * 501).status_code == 201


def test_a_file_over_the_limit_is_refused_before_a_byte_is_sent(client: Client, settings: Any) -> None:
    settings.MAX_MEDIUM_BYTES = 1_000
    assert begin(client, b"x" * 1_001).status_code == 413


@pytest.mark.parametrize(
    "content",
    [b"<html><script>" * 9, b"%PDF-1.7" + b"0" * 100, b"PK\x03\x04" + b"0" * 100, b"MZ" + b"0" * 100, b"<svg onload=x>" * 9],
    ids=["HTML", "PDF", "archive", "program", "SVG"],
)  # fmt: skip
def test_other_kinds_are_refused_by_their_content_whatever_they_are_called(client: Client, content: bytes) -> None:
    key = begin(client, content, "tower.jpg").json()["id"]
    refused = send(client, key, 0, content)
    assert (refused.status_code, refused.json()["error"]["code"]) == (422, "unsupported_type")
    assert client.get(f"{UPLOADS}/{key}").status_code == 404
    assert Medium.objects.count() == 0


def test_a_kind_that_is_hidden_by_small_parts_is_refused_at_the_end(client: Client) -> None:
    content = b"<html>" + b"x" * 100
    key = begin(client, content).json()["id"]
    assert send(client, key, 0, content[:5]).status_code == 204
    assert send(client, key, 5, content[5:]).json()["error"]["code"] == "unsupported_type"


@pytest.mark.parametrize(("offset", "content"), [("0", b"x" * 11), ("-1", b"x"), ("", b"x"), ("x", b"x"), ("9" * 20, b"x")])
def test_bytes_that_do_not_fit_are_refused(client: Client, offset: str, content: bytes) -> None:
    key = begin(client, b"x" * 10).json()["id"]
    answer = client.patch(
        f"{UPLOADS}/{key}", content, content_type="application/offset+octet-stream", headers={"Upload-Offset": offset} if offset else {}
    )
    assert answer.status_code == 400
    assert MediaUpload.objects.get().received_bytes == 0


def test_a_part_that_is_too_large_is_refused_with_the_size_that_is_not(client: Client) -> None:
    key = begin(client, b"x" * 3 * PART_BYTES).json()["id"]
    refused = send(client, key, 0, b"x" * (PART_BYTES + 1))
    assert (refused.status_code, refused.json()["error"]["details"]) == (413, {"part_bytes": PART_BYTES})
    assert client.patch(f"{UPLOADS}/{key}", b"x", content_type="application/json").status_code == 415


def test_a_full_disk_is_told_and_what_was_received_stays(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    content = dji_photo()
    key = begin(client, content).json()["id"]
    send(client, key, 0, content[:100])

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(uploads, "store_file", full)
        refused = send(client, key, 100, content[100:])
    assert (refused.status_code, refused.json()["error"]["code"]) == (507, "store_full")
    assert Medium.objects.count() == 0
    assert client.get(f"{UPLOADS}/{key}").json()["received_bytes"] == len(content)
    assert send(client, key, len(content), b"").status_code == 204  # nothing is missing but its end
    assert Medium.objects.get().sha256 == sha256_of(content)


@pytest.mark.parametrize("role", [Role.VIEWER, Role.CURATOR])
def test_only_operators_send(role: Role, client: Client) -> None:
    key = begin(client, b"x" * 10).json()["id"]
    other = client_of(a_user(role))
    assert {begin(other, b"x").status_code, send(other, key, 0, b"x").status_code, other.delete(f"{UPLOADS}/{key}").status_code} == {403}


def test_what_is_named_with_an_upload_is_the_organisations_own(client: Client) -> None:
    for stated in ({"mission": "00000000-0000-4000-8000-000000000000"}, {"target": 999}, {"uav": 999}, {"asset": 999}):
        refused = begin(client, b"x", **stated)
        assert (refused.status_code, list(refused.json()["error"]["details"])) == (400, list(stated))


def test_old_uploads_are_forgotten_with_their_bytes(client: Client) -> None:
    content = dji_photo()
    upload(client, content)
    send(client, begin(client, b"\xff\xd8\xff" + b"x" * 100).json()["id"], 0, b"\xff\xd8\xff")
    assert forget_old_uploads() == 0
    unfinished = MediaUpload.objects.get(medium=None)
    MediaUpload.objects.update(updated_at=timezone.now() - timedelta(days=8))
    assert forget_old_uploads() == 2
    assert not part_path(unfinished).exists()
    assert Medium.objects.count() == 1


@pytest.mark.parametrize(
    ("given", "kept"), [("../../etc/passwd", "passwd"), ("C:\\DCIM\\DJI_1.JPG", "DJI_1.JPG"), ("", "file"), ("\x00.\n", "file")]
)
def test_a_name_is_no_way_out_of_the_folder(given: str, kept: str) -> None:
    assert plain_name(given) == kept


def test_a_client_of_tus_asks_what_the_server_can(client: Client) -> None:
    answer = client.options(UPLOADS)
    assert (answer.status_code, answer["Tus-Version"], answer["Tus-Extension"]) == (204, "1.0.0", "creation,termination")
    assert int(answer["Tus-Max-Size"]) > 2**30
    refused = client.post(UPLOADS, headers={"Tus-Resumable": "0.2.2", "Upload-Length": "10"})
    assert (refused.status_code, refused["Tus-Version"]) == (412, "1.0.0")
    assert client.post(UPLOADS, headers={"Upload-Length": "10", "Upload-Metadata": "filename %%%"}).status_code == 400
    assert client.post(UPLOADS, headers={"Upload-Length": "ten"}).status_code == 400
    assert client.post(UPLOADS, {"file_name": "x"}, content_type="application/json", headers={"Upload-Length": "10"}).status_code == 400


@pytest.mark.django_db(transaction=True)
def test_tuspy_sends_a_photo_and_continues_after_a_cut(live_server: Any, tmp_path: Path) -> None:
    content = large_photo()
    path = tmp_path / "DJI_0001.JPG"
    path.write_bytes(content)
    token = create_api_token(user=a_user(), name="companion", expires_at=timezone.now() + timedelta(days=1), scopes=None)
    tus = TusClient(f"{live_server.url}{UPLOADS}", headers={"Authorization": f"Bearer {token}"})
    metadata = {"filename": path.name, "sha256": sha256_of(content)}
    sender = tus.uploader(str(path), chunk_size=1_000_000, metadata=metadata)
    sender.upload_chunk()
    sender.upload_chunk()
    again = TusClient(f"{live_server.url}{UPLOADS}", headers={"Authorization": f"Bearer {token}"})
    continued = again.uploader(str(path), chunk_size=PART_BYTES, url=sender.url)
    assert continued.offset == 2_000_000
    continued.upload()
    medium = Medium.objects.get()
    assert (medium.sha256, medium.file_name) == (sha256_of(content), "DJI_0001.JPG")


@pytest.mark.django_db(transaction=True)
def test_of_two_programs_that_end_uploads_of_one_file_at_once_one_stores_it(settings: Any) -> None:
    content = file_of(picture((800, 600)), quality=95)
    clients = [client_of(a_user()) for _ in range(4)]
    keys = [begin(one, content).json()["id"] for one in clients]

    def finish(place: int) -> int:
        try:
            return int(send(clients[place], keys[place], 0, content).status_code)
        finally:
            connection.close()

    with ThreadPoolExecutor(4) as senders:
        assert list(senders.map(finish, range(4))) == [204] * 4
    assert Medium.objects.get().uploads.count() == 4
