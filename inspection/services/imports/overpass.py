"""Imports an area's infrastructure from Overpass as an upload. The only module that accesses Overpass."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from django.conf import settings
from django.utils import timezone

from inspection.importers.osm.overpass import QUERY_TIMEOUT_S, WrongArea, checked_box, complaint, question
from inspection.importers.osm.records import Extent
from inspection.models import ImportKind, Upload
from inspection.services.imports.uploads import private_folder, store_upload
from inspection.services.proposals.reading import Fault, FileRefused, Progress
from operation.reasons import Reason, reason_of
from workspace.http_client import OutgoingError, OutgoingFailed, fetch
from workspace.models import User

TRIES = 3
PAUSES_S = (5, 20)  # a query cannot be resumed: after an interruption it is repeated as a whole
MAX_PAUSE_S = 60
BUSY = {429, 502, 503, 504}
ATTRIBUTION = "© OpenStreetMap contributors, ODbL 1.0"
_TAIL_BYTES = 4_096
_BLOCK_BYTES = 1024 * 1024


def area_of(parameters: dict[str, Any]) -> Extent:
    """Return the box of the parameters. Raises WrongArea."""
    return checked_box(parameters.get("overpass_bbox"), settings.OVERPASS_MAX_KM2)


def fetch_area(*, parameters: dict[str, Any], created_by: User | None, progress: Progress) -> tuple[Upload, dict[str, Any]]:
    """Return Overpass's data of the area as an upload, with its source. Raises FileRefused."""
    try:
        box = area_of(parameters)
    except WrongArea as error:
        raise FileRefused([Fault("overpass_bbox", reason_of(error))]) from error
    with private_folder() as folder:
        answer = folder / "overpass.json"
        try:
            _ask(question(box, most_bytes=settings.MAX_UPLOAD_BYTES[ImportKind.OSM]), answer, progress)
        except OutgoingError as error:
            raise FileRefused([Fault("", f"Overpass: {error}")]) from error
        if fault := complaint(_tail(answer)):
            raise FileRefused([Fault("", Reason("overpass_incomplete", {"fault": fault}))])
        upload = store_upload(file_name="overpass.json", chunks=_blocks(answer), created_by=created_by)
    now = timezone.now().isoformat()
    return upload, {"source_address": settings.OVERPASS_ADDRESS, "attribution": ATTRIBUTION, "licence": "ODbL 1.0", "fetched_at": now}


def _ask(text: str, to: Path, progress: Progress) -> None:
    for attempt in range(1, TRIES + 1):
        progress(Reason("asking_overpass"), 0.02)
        try:
            fetch(
                settings.OVERPASS_ADDRESS, to=to, max_bytes=settings.MAX_UPLOAD_BYTES[ImportKind.OSM], timeout_s=QUERY_TIMEOUT_S + 20,
                total_s=2 * QUERY_TIMEOUT_S, method="POST", data=urlencode({"data": text}).encode(),
                headers={"Content-Type": "application/x-www-form-urlencoded"},
                progress=lambda size: progress(Reason("size_from_overpass", {"size": round(size / 2**20, 1)}), 0.05),
            )  # fmt: skip
            return
        except OutgoingFailed as error:
            if attempt == TRIES or (error.status is not None and error.status not in BUSY):
                raise
            _wait(min(error.retry_after_s or PAUSES_S[attempt - 1], MAX_PAUSE_S), progress)


def _wait(pause_s: float, progress: Progress) -> None:
    """Wait, checking for cancellation through progress."""
    end_s = time.monotonic() + pause_s
    while (left_s := end_s - time.monotonic()) > 0:
        progress(Reason("overpass_busy", {"seconds": round(left_s)}), 0.02)
        time.sleep(min(left_s, 0.5))


def _tail(path: Path) -> str:
    with path.open("rb") as file:
        file.seek(max(path.stat().st_size - _TAIL_BYTES, 0))
        return file.read().decode(errors="replace")


def _blocks(path: Path) -> Iterator[bytes]:
    with path.open("rb") as file:
        while block := file.read(_BLOCK_BYTES):
            yield block
