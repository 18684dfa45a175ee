"""Files on their way in: received part by part, kept in the database, given to a reader as a file that does not stay."""

import hashlib
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from datetime import timedelta
from pathlib import Path, PurePosixPath

from django.conf import settings
from django.db import transaction
from django.utils import timezone

from inspection.models import ImportProposal, ProposalState, Upload, UploadPart
from workspace.models import User

PART_BYTES = 1024 * 1024
KEPT = timedelta(hours=24)  # an upload that nobody went on with, or that was decided on
_FOLDER_PREFIX = "spanwise-upload-"
_OPEN_STATES = (ProposalState.READING, ProposalState.READY, ProposalState.APPLYING)


class UploadRefused(ValueError):
    """The bytes do not fit to the upload; the message says why and what to do."""


class UploadTooLarge(UploadRefused):
    pass


class UploadGap(UploadRefused):
    """Bytes before these are missing; the upload says how many it has."""


def begin_upload(*, file_name: str, size_bytes: int, created_by: User | None) -> Upload:
    """Raises UploadTooLarge."""
    if size_bytes > settings.LARGEST_UPLOAD_BYTES:
        most = settings.LARGEST_UPLOAD_BYTES / 2**20
        raise UploadTooLarge(f"The file has {size_bytes / 2**20:.0f} MiB; at most {most:.0f} MiB are taken. Cut it into parts.")
    return Upload.objects.create(file_name=plain_name(file_name), size_bytes=size_bytes, created_by=created_by)


def receive_part(*, upload: Upload, first_byte: int, content: bytes) -> Upload:
    """Keep the bytes that begin at first_byte; what is there already is not written twice. Raises UploadRefused."""
    if not content or len(content) > PART_BYTES:
        raise UploadRefused(f"A part has 1 to {PART_BYTES} bytes.")
    with transaction.atomic():
        held = Upload.objects.select_for_update().get(pk=upload.pk)
        end = first_byte + len(content)
        if end > held.size_bytes:
            raise UploadRefused(f"The file was announced with {held.size_bytes} bytes; this part would end at {end}.")
        if end <= held.received_bytes:
            return held  # sent again because its answer was lost
        if first_byte != held.received_bytes:
            raise UploadGap(f"Go on from byte {held.received_bytes}.")
        UploadPart.objects.create(upload=held, first_byte=first_byte, content=content)
        held.received_bytes = end
        if held.is_complete:
            held.sha256 = _sha256(held)
        held.save(update_fields=["received_bytes", "sha256", "updated_at"])
    return held


def store_upload(*, file_name: str, chunks: Iterable[bytes], created_by: User | None) -> Upload:
    """An upload of what the program itself has fetched or made."""
    with transaction.atomic():
        upload = Upload.objects.create(file_name=plain_name(file_name), size_bytes=0, created_by=created_by)
        digest = hashlib.sha256()
        size = 0
        for part in _parts(chunks):
            UploadPart.objects.create(upload=upload, first_byte=size, content=part)
            digest.update(part)
            size += len(part)
        upload.size_bytes = upload.received_bytes = size
        upload.sha256 = digest.hexdigest()
        upload.save()
    return upload


@contextmanager
def upload_as_file(upload: Upload) -> Iterator[Path]:
    """The upload as a file of its own name that only this user may read, gone afterwards. Raises UploadRefused if it is not whole."""
    if not upload.is_complete:
        raise UploadRefused("The file has not arrived whole.")
    folder = Path(tempfile.mkdtemp(prefix=_FOLDER_PREFIX, dir=upload_folder()))  # mode 0700
    try:
        path = folder / plain_name(upload.file_name)
        digest = hashlib.sha256()
        with path.open("wb") as file:
            for content in upload.parts.order_by("first_byte").values_list("content", flat=True).iterator(chunk_size=4):
                file.write(content)
                digest.update(content)
        if digest.hexdigest() != upload.sha256:
            raise UploadRefused("The stored file is damaged. Send it again.")
        yield path
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def upload_folder() -> Path:
    folder = settings.STATE_DIR / "uploads"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    return folder


def plain_name(file_name: str) -> str:
    """The last part of a name that a browser or a server gave, without what a file system or a log could trip over."""
    name = PurePosixPath(file_name.replace("\\", "/")).name
    name = "".join(character for character in name if character.isprintable() and character not in '<>:"|?*')
    return name[-200:].lstrip(".") or "file"


def forget_old_uploads() -> int:
    """Delete uploads that nothing needs any more, and files that a killed worker has left."""
    now = timezone.now()
    for folder in upload_folder().glob(f"{_FOLDER_PREFIX}*"):
        with suppress(OSError):
            if now.timestamp() - folder.stat().st_mtime > settings.CELERY_TASK_TIME_LIMIT:
                shutil.rmtree(folder, ignore_errors=True)
    needed = ImportProposal.objects.filter(state__in=_OPEN_STATES, upload__isnull=False).values("upload")
    old = Upload.objects.filter(updated_at__lt=now - KEPT).exclude(pk__in=needed)
    deleted, _ = old.delete()
    return deleted


def _sha256(upload: Upload) -> str:
    digest = hashlib.sha256()
    for content in upload.parts.order_by("first_byte").values_list("content", flat=True).iterator(chunk_size=4):
        digest.update(content)
    return digest.hexdigest()


def _parts(chunks: Iterable[bytes]) -> Iterator[bytes]:
    """The same bytes in parts of PART_BYTES."""
    held = bytearray()
    for chunk in chunks:
        held += chunk
        while len(held) >= PART_BYTES:
            yield bytes(held[:PART_BYTES])
            del held[:PART_BYTES]
    if held:
        yield bytes(held)
