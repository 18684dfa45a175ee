"""Uploads of media: announced by hash and size, received in parts that continue where a connection was cut."""

import errno
import hashlib
import os
from collections.abc import Collection
from dataclasses import dataclass
from datetime import timedelta
from io import BufferedReader
from pathlib import Path, PurePosixPath

from django.conf import settings
from django.db import transaction
from django.db.models import Sum
from django.utils import timezone
from django.utils.translation import gettext as _

from inspection.models import Asset
from missions.models import InspectionTarget, Mission, Uav
from results.media_metadata.media_types import HEAD_BYTES, MediaType, media_type_of
from results.models import MediaUpload, Medium, MediumKind, MediumState, Placement
from results.models.media import MAX_FILE_NAME_LENGTH
from results.services.store import original_name, store_file
from workspace.leases import lock_until_end
from workspace.models import User

PART_BYTES = 4 * 1024 * 1024
MAX_OPEN_UPLOADS = 5_000  # of one organisation
KEPT = timedelta(days=7)  # since the last part of an unfinished upload
SPACE_LOCK = 0x05A7_0034  # advisory lock, with the organisation: one upload at a time takes room


class MediaUploadRefused(ValueError):
    """Raised when bytes are not taken; the message has the reason and the remedy."""


class WrongOffset(MediaUploadRefused):
    """Raised when a part does not begin where the received bytes end; the upload states how many there are."""


class TooLarge(MediaUploadRefused):
    pass


class NoRoom(MediaUploadRefused):
    """Raised when the organisation's media take all of its room."""


class UnsupportedType(MediaUploadRefused):
    pass


class WrongHash(MediaUploadRefused):
    """Raised when all bytes are received and are not those that were announced. The upload begins again at its first byte."""


class StoreFull(OSError):
    """Raised when the disk of the store is full. What was received before stays."""


@dataclass(frozen=True)
class Subject:
    """What an upload states that its file shows."""

    mission: Mission | None = None
    uav: Uav | None = None
    target: InspectionTarget | None = None
    asset: Asset | None = None


@dataclass(frozen=True)
class MediaUse:
    used_bytes: int
    max_bytes: int


def media_use(organisation_id: int) -> MediaUse:
    """Return how much room an organisation's media and open uploads take."""
    stored = Medium.objects.filter(organisation=organisation_id).aggregate(bytes=Sum("size_bytes"))["bytes"] or 0
    open_ones = MediaUpload.objects.filter(organisation=organisation_id, medium=None).aggregate(bytes=Sum("size_bytes"))["bytes"] or 0
    return MediaUse(stored + open_ones, settings.MEDIA_BYTES)


def unfinished_upload(user: User, sha256: str, size_bytes: int) -> MediaUpload | None:
    """Return a user's unfinished upload of a file, which a later page or program continues."""
    own = MediaUpload.objects.filter(organisation=user.organisation_id, created_by=user, medium=None)
    return own.filter(sha256=sha256, size_bytes=size_bytes).order_by("created_at").first()


def known_media(organisation_id: int, hashes: Collection[str]) -> dict[str, Medium]:
    """Return the organisation's media of these hashes."""
    return {medium.sha256: medium for medium in Medium.objects.filter(organisation=organisation_id, sha256__in=hashes)}


def begin_upload(*, user: User, file_name: str, size_bytes: int, sha256: str = "", subject: Subject = Subject()) -> MediaUpload:
    """Begin an upload. Raises TooLarge, or NoRoom for one that exceeds the organisation's room."""
    if size_bytes > settings.MAX_MEDIUM_BYTES:
        raise TooLarge(
            _("The file has %(size)s MiB; at most %(limit)s MiB are taken.")
            % {"size": f"{size_bytes / 2**20:,.1f}", "limit": f"{settings.MAX_MEDIUM_BYTES / 2**20:,.0f}"}
        )
    with transaction.atomic():
        lock_until_end(SPACE_LOCK, user.organisation_id)
        use = media_use(user.organisation_id)
        if use.used_bytes + size_bytes > use.max_bytes:
            raise NoRoom(
                _("Photos and videos take %(used)s of %(limit)s GiB. Delete some, or ask the operator of this installation for room.")
                % {"used": f"{use.used_bytes / 2**30:,.1f}", "limit": f"{use.max_bytes / 2**30:,.1f}"}
            )
        if MediaUpload.objects.filter(organisation=user.organisation_id, medium=None).count() >= MAX_OPEN_UPLOADS:
            raise NoRoom(_("%(number)s uploads are unfinished. Finish or cancel some first.") % {"number": f"{MAX_OPEN_UPLOADS:,}"})
        upload = MediaUpload(
            organisation_id=user.organisation_id, created_by=user, file_name=plain_name(file_name), size_bytes=size_bytes, sha256=sha256,
            mission=subject.mission, uav=subject.uav, target=subject.target, asset=subject.asset,
        )  # fmt: skip
        upload.save()
    return upload


def receive_part(*, upload: MediaUpload, offset: int, content: bytes) -> MediaUpload:
    """Write the bytes that begin at `offset`. With the last ones, check the hash and store the file.

    Raises UploadRefused or StoreFull.
    """
    with transaction.atomic():
        held = _held(upload)
        if held.medium_id is not None or offset != held.received_bytes:
            raise WrongOffset(
                _("The part begins at byte %(offset)s; continue from byte %(received)s.")
                % {"offset": offset, "received": held.received_bytes}
            )
        if offset + len(content) > held.size_bytes:
            raise MediaUploadRefused(
                _("The file was announced with %(size)s bytes; this part would end at %(end)s.")
                % {"size": held.size_bytes, "end": offset + len(content)}
            )
        if offset == 0 and content and len(content) >= min(HEAD_BYTES, held.size_bytes):
            _supported_type(content)
        _write(held, offset, content)
        held.received_bytes = offset + len(content)
        held.save(update_fields=["received_bytes", "updated_at"])
    return finish_upload(upload=held) if held.received_bytes == held.size_bytes else held


def finish_upload(*, upload: MediaUpload) -> MediaUpload:
    """Check a complete upload and store its file as a medium, unless the organisation has it already.

    Raises WrongHash or UnsupportedType.
    """
    with transaction.atomic():
        held = _held(upload)
        if held.medium_id is not None or held.received_bytes < held.size_bytes:
            return held
        path = part_path(held)
        with path.open("rb") as file:
            os.fsync(file.fileno())
            sha256 = _sha256(file)
            file.seek(0)
            media_type = _supported_type(file.read(HEAD_BYTES))
        is_right = held.sha256 in ("", sha256)
        if is_right:
            held.medium = _medium_of(held, sha256, media_type)
            held.sha256 = sha256
        else:
            held.received_bytes = 0
        held.save(update_fields=["received_bytes", "medium", "sha256", "updated_at"])
    path.unlink(missing_ok=True)
    if not is_right:
        raise WrongHash(_("The file that arrived is not the announced one: its SHA-256 differs. Nothing was stored. Send it again."))
    return held


def delete_upload(*, upload: MediaUpload) -> None:
    """Cancel an upload; what has become of a finished one stays."""
    part_path(upload).unlink(missing_ok=True)
    upload.delete()


def forget_old_uploads() -> int:
    """Delete uploads that no part has come for, and records of finished ones. Returns how many."""
    old = MediaUpload.objects.filter(updated_at__lt=timezone.now() - KEPT)
    for upload in old:
        delete_upload(upload=upload)
    known = {str(key) for key in MediaUpload.objects.filter(medium=None).values_list("pk", flat=True)}
    for path in upload_folder().glob("*.part"):
        is_old = path.stat().st_mtime < (timezone.now() - KEPT).timestamp()
        if is_old and path.stem not in known:
            path.unlink(missing_ok=True)
    return len(old)


def plain_name(file_name: str) -> str:
    """Return the last part of a file name, without characters that are unsafe in file systems, headers or logs."""
    name = PurePosixPath(file_name.replace("\\", "/")).name
    name = "".join(character for character in name if character.isprintable() and character not in '<>:"|?*')
    return name[-MAX_FILE_NAME_LENGTH:].lstrip(".") or "file"


def part_path(upload: MediaUpload) -> Path:
    return upload_folder() / f"{upload.pk}.part"


def upload_folder() -> Path:
    folder = Path(settings.UPLOAD_DIR) / "media"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    return folder


def adopt_subject(medium: Medium, subject: Subject) -> None:
    """Give a medium without mission and place the subject of a repeated upload; the worker places it again."""
    is_free = medium.mission_id is None and medium.placement in (Placement.WAITING, Placement.UNPLACED)
    if not is_free or subject == Subject():
        return
    medium.mission, medium.uav = subject.mission, subject.uav or medium.uav
    medium.target, medium.asset = subject.target, subject.asset or (None if subject.target is None else subject.target.asset)
    is_stated = subject.target is not None or subject.asset is not None
    medium.placement = Placement.STATED if is_stated else Placement.WAITING
    medium.state = MediumState.WAITING
    medium.save(update_fields=["mission", "uav", "target", "asset", "placement", "state", "updated_at"])


def _held(upload: MediaUpload) -> MediaUpload:
    """Return the locked row; bytes that the disk has lost are asked for again."""
    held = MediaUpload.objects.select_for_update(of=["self"]).get(pk=upload.pk)
    if held.medium_id is None:
        path = part_path(held)
        held.received_bytes = min(held.received_bytes, path.stat().st_size if path.exists() else 0)
    return held


def _write(upload: MediaUpload, offset: int, content: bytes) -> None:
    """Write a part; bytes behind it, of a part whose transaction was not committed, are cut off."""
    descriptor = os.open(part_path(upload), os.O_WRONLY | os.O_CREAT, 0o600)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.truncate(offset)
            file.seek(offset)
            file.write(content)
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            raise StoreFull(*error.args) from error
        raise


def _supported_type(head: bytes) -> MediaType:
    media_type = media_type_of(head[:HEAD_BYTES])
    if media_type is None:
        raise UnsupportedType(_("By its content the file is none of the supported kinds: JPEG, PNG, TIFF, DNG, WebP, HEIC, MP4 or MOV."))
    return media_type


def _sha256(file: BufferedReader) -> str:
    return hashlib.file_digest(file, "sha256").hexdigest()


def _medium_of(upload: MediaUpload, sha256: str, media_type: MediaType) -> Medium:
    """Return the organisation's medium of this content, stored now if it is new. Two uploads of one content wait for each other."""
    subject_stated = upload.target_id is not None or upload.asset_id is not None
    asset_id = upload.asset_id or (upload.target.asset_id if upload.target is not None else None)
    medium, is_new = Medium.objects.get_or_create(
        organisation_id=upload.organisation_id,
        sha256=sha256,
        defaults={
            "kind": MediumKind.VIDEO if media_type.is_video else MediumKind.PHOTO,
            "media_type": media_type.name,
            "file_name": upload.file_name,
            "size_bytes": upload.size_bytes,
            "state": MediumState.WAITING,
            "mission_id": upload.mission_id,
            "uav_id": upload.uav_id,
            "target_id": upload.target_id,
            "asset_id": asset_id,
            "placement": Placement.STATED if subject_stated else Placement.WAITING,
            "uploaded_by_id": upload.created_by_id,
        },
    )
    if not is_new:
        adopt_subject(medium, Subject(upload.mission, upload.uav, upload.target, upload.asset))
    else:
        try:
            store_file(part_path(upload), original_name(upload.organisation_id, sha256))
        except OSError as error:
            if error.errno in (errno.ENOSPC, errno.EDQUOT):
                raise StoreFull(*error.args) from error
            raise
    return medium
