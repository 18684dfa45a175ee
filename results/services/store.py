"""The media store: bytes by organisation and SHA-256, in a folder or wherever the storage of the settings puts them.

Names hold the organisation, so that a hash does not reveal what others have, and an organisation's files can be counted and removed.
"""

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from django.core.files import File
from django.core.files.storage import Storage, storages

from results.media_metadata.photo_reader import EDGES_PX
from results.models import Medium


class MediumMissing(OSError):
    """Raised where the store has no file of this name."""


class _ReceivedFile(File):
    """A local file that a storage of local files may move instead of copying it."""

    def temporary_file_path(self) -> str:
        return str(self.name)


def store() -> Storage:
    return storages["media"]


def original_name(organisation_id: int, sha256: str) -> str:
    return f"{organisation_id}/originals/{sha256[:2]}/{sha256}"


def derivative_name(organisation_id: int, sha256: str, edge: int) -> str:
    return f"{organisation_id}/derivatives/{sha256[:2]}/{sha256}-{edge}.webp"


def store_file(path: Path, name: str) -> None:
    """Store a local file, which may be moved. A file of the name, left by a program that was killed, is replaced."""
    if store().exists(name):
        store().delete(name)
    with path.open("rb") as file:
        stored_name = store().save(name, _ReceivedFile(file, str(path)))
    if stored_name != name:
        store().delete(stored_name)
        raise OSError(f"the media store named {name} {stored_name}")


def open_stored(name: str) -> IO[bytes]:
    """Open a file of the store. Raises MediumMissing."""
    try:
        return store().open(name, "rb")
    except FileNotFoundError as error:
        raise MediumMissing(name) from error


@contextmanager
def original_as_file(medium: Medium) -> Iterator[IO[bytes]]:
    """Yield the original as a local file, copied if the store is elsewhere. Raises MediumMissing."""
    with open_stored(original_name(medium.organisation_id, medium.sha256)) as stored:
        try:
            stored.fileno()
        except (OSError, AttributeError):
            with tempfile.TemporaryFile() as copy:
                shutil.copyfileobj(stored, copy, 1024 * 1024)
                yield copy
            return
        yield stored


def delete_files(organisation: int, sha256: str) -> None:
    """Delete original and derivatives, if they are there."""
    for name in (original_name(organisation, sha256), *(derivative_name(organisation, sha256, edge) for edge in EDGES_PX)):
        store().delete(name)
