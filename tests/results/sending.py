"""Sending media as a client does, and reading them as the worker does."""

import hashlib
from typing import Any

from django.test import Client

from results.models import Medium
from results.services.reading import read_waiting

UPLOADS = "/api/v1/media-uploads"
PART_TYPE = "application/offset+octet-stream"


def sha256_of(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def begin(client: Client, content: bytes, file_name: str = "DJI_0001.JPG", **stated: Any) -> Any:
    body = {"file_name": file_name, "size_bytes": len(content), "sha256": sha256_of(content)} | stated
    return client.post(UPLOADS, body, content_type="application/json")


def send(client: Client, upload: str, offset: int, content: bytes) -> Any:
    return client.patch(f"{UPLOADS}/{upload}", content, content_type=PART_TYPE, headers={"Upload-Offset": str(offset)})


def upload(client: Client, content: bytes, file_name: str = "DJI_0001.JPG", **stated: Any) -> Medium:
    begun = begin(client, content, file_name, **stated)
    assert begun.status_code == 201, begun.json()
    assert send(client, begun.json()["id"], 0, content).status_code == 204
    return Medium.objects.get(uploads=begun.json()["id"])


def upload_and_read(client: Client, content: bytes, file_name: str = "DJI_0001.JPG", **stated: Any) -> Medium:
    medium = upload(client, content, file_name, **stated)
    while read_waiting(budget_s=60.0):
        pass
    medium.refresh_from_db()
    return medium
