"""Uploads: received part by part, stored in the database, and passed to a reader as a temporary file."""

import fcntl
import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path, PurePosixPath
from uuid import UUID, uuid4

from django.conf import settings
from django.db import transaction
from django.db.models import Count, Q, Sum
from django.utils import timezone
from django.utils.translation import gettext as _

from inspection.models import ImportProposal, ProposalState, Upload, UploadPart
from workspace.models import Organisation, User

PART_BYTES = 1024 * 1024
MAX_UPLOADS = 200  # stored, of one organisation
KEPT = timedelta(hours=24)  # an abandoned upload, or one that was decided on
_FOLDER_PREFIX = "spanwise-upload-"
_OPEN_STATES = (ProposalState.READING, ProposalState.READY, ProposalState.APPLYING)
_DECIDED_STATES = (ProposalState.APPLIED, ProposalState.DISCARDED)


class UploadRefused(ValueError):
    """Raised when the bytes do not fit the upload; the message has the reason and the remedy."""


class UploadTooLarge(UploadRefused):
    pass


class TooManyUploads(UploadRefused):
    """Raised when the stored files of an organisation use all of its space."""


class UploadGap(UploadRefused):
    """Raised when earlier bytes are missing, or some of these were already received; the upload states how many it has."""


class UploadInUse(UploadRefused):
    """Raised when the file's changes are still to be reviewed."""


def begin_upload(*, file_name: str, size_bytes: int, created_by: User | None) -> Upload:
    """Begin an upload. Raises UploadTooLarge, or TooManyUploads for one that exceeds the organisation's space.

    Concurrent calls are serialised.
    """
    _refuse_more_than(max(settings.MAX_UPLOAD_BYTES.values()), size_bytes)
    with transaction.atomic():
        if created_by is not None:
            Organisation.objects.select_for_update(no_key=True).filter(pk=created_by.organisation_id).values_list("pk").first()
            own = Upload.objects.filter(created_by__organisation=created_by.organisation_id)
            kept = own.aggregate(bytes=Sum("size_bytes"), number=Count("pk"))
            if (kept["bytes"] or 0) + size_bytes > settings.UPLOADS_BYTES or kept["number"] >= MAX_UPLOADS:
                raise TooManyUploads(_("Your organisation's files that wait take all the room they may. Decide on them, or delete some."))
        return Upload.objects.create(file_name=plain_name(file_name), size_bytes=size_bytes, created_by=created_by)


def check_size_for(kind: str, size_bytes: int) -> None:
    """Check the limit of the kind of data. Raises UploadTooLarge."""
    _refuse_more_than(settings.MAX_UPLOAD_BYTES[kind], size_bytes)


def delete_upload(*, upload: Upload) -> None:
    """Delete an upload. Raises UploadInUse."""
    with transaction.atomic():
        if upload.proposals.filter(state__in=_OPEN_STATES).exists():
            raise UploadInUse(_("The file is part of an import that is not decided yet. Discard that first."))
        upload.delete()


def receive_part(*, upload: Upload, first_byte: int, content: bytes) -> Upload:
    """Store the bytes that begin at first_byte; received ones are not written again. Raises UploadRefused."""
    if not content or len(content) > PART_BYTES:
        raise UploadRefused(_("A part has 1 to %(part_bytes)s bytes.") % {"part_bytes": PART_BYTES})
    with transaction.atomic():
        held = Upload.objects.select_for_update().get(pk=upload.pk)
        end = first_byte + len(content)
        if end > held.size_bytes:
            raise UploadRefused(
                _("The file was announced with %(size_bytes)s bytes; this part would end at %(end)s.")
                % {"size_bytes": held.size_bytes, "end": end}
            )
        if end <= held.received_bytes:
            return held  # repeated because its response was lost
        if first_byte != held.received_bytes:
            raise UploadGap(
                _("The part begins at byte %(first_byte)s; go on from byte %(received_bytes)s.")
                % {"first_byte": first_byte, "received_bytes": held.received_bytes}
            )
        UploadPart.objects.create(upload=held, first_byte=first_byte, content=content)
        held.received_bytes = end
        if held.is_complete:
            held.sha256 = _sha256(held)
        held.save(update_fields=["received_bytes", "sha256", "updated_at"])
    return held


def store_upload(*, file_name: str, chunks: Iterable[bytes], created_by: User | None, key: UUID | None = None) -> Upload:
    """Return an upload of what the program itself has fetched or made."""
    with transaction.atomic():
        upload = Upload.objects.create(id=key or uuid4(), file_name=plain_name(file_name), size_bytes=0, created_by=created_by)
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
    """Yield the upload as a temporary file of its own name that only this user can read. Raises UploadRefused if it is incomplete."""
    if not upload.is_complete:
        raise UploadRefused(_("The file has not arrived whole."))
    with private_folder() as folder:
        path = folder / plain_name(upload.file_name)
        digest = hashlib.sha256()
        with path.open("wb") as file:
            for content in upload.parts.order_by("first_byte").values_list("content", flat=True).iterator(chunk_size=1):
                file.write(content)
                digest.update(content)
        if digest.hexdigest() != upload.sha256:
            raise UploadRefused(_("The stored file is damaged. Send it again."))
        yield path


@contextmanager
def private_folder() -> Iterator[Path]:
    """Yield a temporary folder: removed here, or after a SIGKILL by the next caller.

    The process that uses a folder locks it, and the kernel releases the lock when the process ends.
    """
    with _folder_lock():
        _remove_left_folders()
        folder = Path(tempfile.mkdtemp(prefix=_FOLDER_PREFIX, dir=upload_folder()))  # mode 0700
        held = os.open(folder, os.O_RDONLY)
        fcntl.flock(held, fcntl.LOCK_EX)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(held)


def upload_folder() -> Path:
    folder = Path(settings.UPLOAD_DIR)
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    return folder


def plain_name(file_name: str) -> str:
    """Return the last part of a file name from a browser or a server, without characters that are unsafe in file systems or logs."""
    name = PurePosixPath(file_name.replace("\\", "/")).name
    name = "".join(character for character in name if character.isprintable() and character not in '<>:"|?*')
    return name[-200:].lstrip(".") or "file"


def forget_old_uploads() -> int:
    """Delete uploads that are no longer needed, and files of killed workers. Returns how many rows were deleted."""
    with _folder_lock():
        _remove_left_folders()
    states = ImportProposal.objects.filter(upload__isnull=False)
    open_ones = states.filter(state__in=_OPEN_STATES).values("upload")
    is_old = Q(updated_at__lt=timezone.now() - KEPT) | Q(pk__in=states.filter(state__in=_DECIDED_STATES).values("upload"))
    deleted, _by_model = Upload.objects.filter(is_old).exclude(pk__in=open_ones).delete()
    return deleted


@contextmanager
def _folder_lock() -> Iterator[None]:
    handle = os.open(upload_folder(), os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def _remove_left_folders() -> None:
    for folder in upload_folder().glob(f"{_FOLDER_PREFIX}*"):
        try:
            handle = os.open(folder, os.O_RDONLY)
        except FileNotFoundError:
            continue
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(folder, ignore_errors=True)
        except BlockingIOError:
            pass  # in use by a reader
        finally:
            os.close(handle)


def _refuse_more_than(most_bytes: int, size_bytes: int) -> None:
    if size_bytes > most_bytes:
        raise UploadTooLarge(
            _("The file has %(value)s MiB; at most %(value_2)s MiB are taken. Cut it into parts.")
            % {"value": f"{size_bytes / 2**20:,.1f}", "value_2": f"{most_bytes / 2**20:,.0f}"}
        )


def _sha256(upload: Upload) -> str:
    digest = hashlib.sha256()
    for content in upload.parts.order_by("first_byte").values_list("content", flat=True).iterator(chunk_size=1):
        digest.update(content)
    return digest.hexdigest()


def _parts(chunks: Iterable[bytes]) -> Iterator[bytes]:
    """Yield the same bytes in parts of PART_BYTES."""
    held = bytearray()
    for chunk in chunks:
        held += chunk
        while len(held) >= PART_BYTES:
            yield bytes(held[:PART_BYTES])
            del held[:PART_BYTES]
    if held:
        yield bytes(held)
