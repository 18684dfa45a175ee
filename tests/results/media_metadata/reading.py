"""Reading a photo's bytes as the worker does."""

import io
import tempfile
from pathlib import Path

from results.media_metadata.photo_process import ReadingLimits, ReadPhoto, read_photo
from results.media_metadata.record import MediaRecord


def read(content: bytes, folder: Path, limits: ReadingLimits | None = None) -> ReadPhoto:
    with tempfile.TemporaryFile() as file:
        file.write(content)
        return read_photo(file, folder, limits or ReadingLimits())


def record(content: bytes, folder: Path) -> MediaRecord:
    found = read(content, folder)
    assert (found.record, found.fault) != (None, "")
    assert found.record is not None, found.fault
    return found.record


def size_of(path: Path) -> tuple[int, int]:
    from PIL import Image  # noqa: PLC0415

    with Image.open(io.BytesIO(path.read_bytes())) as image:
        return image.size
