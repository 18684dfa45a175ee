"""The program of a child process that reads one photo from its standard input, writes derivatives and answers in one line of JSON.

Nothing else decodes photos: a file from elsewhere can crash or bloat this process, but not a worker.
"""

import json
import resource
import sys
import warnings
from pathlib import Path
from typing import IO

from PIL import Image, ImageOps, UnidentifiedImageError

from results.media_metadata.exif import record_of
from results.media_metadata.media_types import HEAD_BYTES, media_type_of
from results.media_metadata.record import MediaRecord, record_to_json
from results.media_metadata.xmp import Properties, XmpFault, properties_of

EDGES_PX = (1600, 400)  # of derivatives, longest edge
QUALITY = 80  # of WebP
MAX_DERIVATIVE_BYTES = 16 * 2**20
BYTES_PER_PIXEL = 4  # decoded, at most, of what Pillow decodes whole


class PhotoRefused(Exception):
    """The message is the code of the fault."""


def main() -> None:
    """Read the job from the command line: folder, limits."""
    folder, memory_bytes, processor_s, max_pixels, max_decoded_bytes = sys.argv[2], *(int(word) for word in sys.argv[3:7])
    for kind, limit in (
        (resource.RLIMIT_AS, memory_bytes),
        (resource.RLIMIT_CPU, processor_s),
        (resource.RLIMIT_FSIZE, MAX_DERIVATIVE_BYTES),
        (resource.RLIMIT_CORE, 0),
    ):
        resource.setrlimit(kind, (limit, limit))
    answer: dict[str, object] = {}
    try:
        read_photo(sys.stdin.buffer, Path(folder), answer, max_pixels=max_pixels, max_decoded_bytes=max_decoded_bytes)
    except MemoryError:
        answer["fault"] = "memory"
    except PhotoRefused as error:
        answer["fault"] = str(error)
    print(json.dumps(answer), flush=True)


def read_photo(file: IO[bytes], folder: Path, answer: dict[str, object], *, max_pixels: int, max_decoded_bytes: int) -> None:
    """Fill `answer` with the record, the size and the derivatives' sizes, as far as the file can be read. Raises PhotoRefused."""
    media_type = media_type_of(file.read(HEAD_BYTES))
    file.seek(0)
    if media_type is None or not media_type.pillow_formats:
        raise PhotoRefused("not_decoded")
    Image.MAX_IMAGE_PIXELS = None  # checked here, before anything is decoded
    warnings.simplefilter("ignore")
    try:
        picture = Image.open(file, formats=media_type.pillow_formats)
    except UnidentifiedImageError as error:
        raise PhotoRefused("undecodable") from error
    except (OSError, ValueError, SyntaxError, OverflowError) as error:  # a header that ends early or contradicts itself
        raise PhotoRefused("undecodable") from error
    record = _record_of(picture)
    is_turned = record.orientation >= 5
    width_px, height_px = (picture.height, picture.width) if is_turned else picture.size
    answer |= {"record": record_to_json(record), "width_px": width_px, "height_px": height_px}
    if picture.width * picture.height > max_pixels:
        raise PhotoRefused("too_many_pixels")
    is_reduced = media_type.pillow_formats[0] == "JPEG" and not picture.info.get("progressive")  # decoded at a fraction of its size
    if not is_reduced and picture.width * picture.height * BYTES_PER_PIXEL > max_decoded_bytes:
        raise PhotoRefused("too_large_to_decode")
    answer["derivatives"] = _write_derivatives(picture, folder, record.orientation)


def _record_of(picture: Image.Image) -> MediaRecord:
    faults: tuple[str, ...] = ()
    xmp: Properties = {}
    packet = picture.info.get("xmp") or picture.info.get("XML:com.adobe.xmp")
    if packet:
        try:
            xmp = properties_of(packet.encode() if isinstance(packet, str) else packet)
        except XmpFault:
            faults = ("xmp",)
    try:
        exif = picture.getexif()
    except Exception:
        exif, faults = Image.Exif(), (*faults, "exif")
    return record_of(exif, xmp, faults)


def _write_derivatives(picture: Image.Image, folder: Path, orientation: int) -> dict[str, list[int]]:
    """Write the derivatives, upright and without metadata; return their sizes by longest edge. Raises PhotoRefused."""
    largest = EDGES_PX[0]
    try:
        if picture.format in ("JPEG", "MPO"):
            picture.draft("RGB", (largest, largest))
        picture.load()
    except (OSError, ValueError, SyntaxError, OverflowError, EOFError) as error:
        raise PhotoRefused("truncated" if "truncated" in str(error) or isinstance(error, EOFError) else "undecodable") from error
    if picture.mode.startswith(("I", "F")):  # 16 bits and more a channel
        low, high = picture.getextrema()
        scale = 255.0 / max(float(high) - float(low), 1.0)  # type: ignore[arg-type]
        picture = picture.convert("F").point(lambda value: (value - float(low)) * scale).convert("L")  # type: ignore[arg-type]
    picture = picture.convert("RGB")
    picture.thumbnail((largest, largest), Image.Resampling.LANCZOS, reducing_gap=3.0)
    picture.getexif().clear()
    picture.getexif()[0x0112] = orientation
    picture = ImageOps.exif_transpose(picture)
    sizes = {}
    for edge in EDGES_PX:
        picture.thumbnail((edge, edge), Image.Resampling.LANCZOS)
        bare = Image.new("RGB", picture.size)  # takes the pixels alone: no EXIF, XMP, profile or text
        bare.paste(picture)
        bare.save(folder / f"{edge}.webp", "WEBP", quality=QUALITY, method=2)
        sizes[str(edge)] = list(bare.size)
    return sizes
