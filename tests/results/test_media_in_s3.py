"""Photos in a bucket: the same uploads, readings, downloads and deletions, on an S3 server."""

from collections.abc import Iterator
from typing import Any, NamedTuple
from uuid import uuid4

import boto3
import pytest
from django.core.files.storage import storages
from moto.server import ThreadedMotoServer

from config.environment import media_storage
from results.models import MediumState
from tests.accounts.users import a_user, client_of
from tests.results.photos import dji_photo
from tests.results.sending import sha256_of, upload_and_read

pytestmark = pytest.mark.django_db


class Bucket(NamedTuple):
    client: Any
    name: str

    def keys(self) -> list[str]:
        return [one["Key"] for one in self.client.list_objects_v2(Bucket=self.name).get("Contents", [])]

    def content(self, key: str) -> bytes:
        found: bytes = self.client.get_object(Bucket=self.name, Key=key)["Body"].read()
        return found


@pytest.fixture
def bucket(monkeypatch: pytest.MonkeyPatch, settings: Any, tmp_path: Any) -> Iterator[Bucket]:
    for name, value in {"AWS_ACCESS_KEY_ID": "key", "AWS_SECRET_ACCESS_KEY": "secret", "AWS_DEFAULT_REGION": "eu-central-1"}.items():
        monkeypatch.setenv(name, value)
    server = ThreadedMotoServer("127.0.0.1", port=0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    name = f"inspections-{uuid4().hex[:8]}"  # the server keeps them for the whole process
    monkeypatch.setenv("SPANWISE_MEDIA_BUCKET", name)
    monkeypatch.setenv("SPANWISE_MEDIA_ENDPOINT", f"http://{host}:{port}")
    client = boto3.client("s3", endpoint_url=f"http://{host}:{port}")
    client.create_bucket(Bucket=name, CreateBucketConfiguration={"LocationConstraint": "eu-central-1"})
    settings.STORAGES = settings.STORAGES | {"media": media_storage(tmp_path)}
    yield Bucket(client, name)
    server.stop()


def test_photos_live_in_a_bucket(bucket: Bucket, django_capture_on_commit_callbacks: Any) -> None:
    assert type(storages["media"]).__name__ == "S3Storage"
    content, client = dji_photo(size=(800, 600)), client_of(a_user())
    medium = upload_and_read(client, content)
    sha256 = sha256_of(content)
    assert (medium.state, medium.width_px) == (MediumState.READY, 800)
    stem = f"{sha256[:2]}/{sha256}"
    assert bucket.keys() == [f"1/derivatives/{stem}-1600.webp", f"1/derivatives/{stem}-400.webp", f"1/originals/{stem}"]
    assert bucket.content(bucket.keys()[-1]) == content
    answer = client.get(f"/api/v1/media/{medium.pk}/file")
    assert (b"".join(answer.streaming_content), answer["Content-Type"]) == (content, "image/jpeg")
    assert b"".join(client.get(f"/api/v1/media/{medium.pk}/previews/400").streaming_content)[:4] == b"RIFF"
    with django_capture_on_commit_callbacks(execute=True):
        assert client.delete(f"/api/v1/media/{medium.pk}").status_code == 204
    assert bucket.keys() == []


def test_what_the_bucket_has_lost_is_told(bucket: Bucket) -> None:
    client = client_of(a_user())
    medium = upload_and_read(client, dji_photo())
    bucket.client.delete_object(Bucket=bucket.name, Key=bucket.keys()[-1])
    assert client.get(f"/api/v1/media/{medium.pk}/file").status_code == 404
