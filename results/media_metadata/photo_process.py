"""Reads a photo in a process of its own, with limits of memory, processor time and pixels."""

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from results.media_metadata.record import MediaRecord, record_from_json

_ROOT = Path(__file__).resolve().parents[2]
_BEGIN = "import sys; sys.path.append(sys.argv[1]); from results.media_metadata.photo_reader import main; main()"
MAX_ANSWER_BYTES = 1024 * 1024


@dataclass(frozen=True)
class ReadingLimits:
    """Limits of one photo. max_decoded_bytes: of pictures that are decoded whole; baseline JPEG is decoded at a fraction of its size."""

    memory_bytes: int = 768 * 2**20  # of addresses, of which Python and Pillow take 150 MiB
    processor_s: int = 30
    answer_s: float = 60.0
    max_pixels: int = 250_000_000
    max_decoded_bytes: int = 320_000_000


@dataclass(frozen=True)
class ReadPhoto:
    """What a photo states and shows. record: None where not even the header is readable; fault: why there are no derivatives.

    width_px, height_px: of the upright picture. derivatives: width and height of the files `EDGE.webp`, by longest edge.
    """

    record: MediaRecord | None
    width_px: int | None
    height_px: int | None
    derivatives: dict[str, tuple[int, int]]
    fault: str = ""


def read_photo(file: IO[bytes], folder: Path, limits: ReadingLimits) -> ReadPhoto:
    """Read a photo; its derivatives are written to `folder`."""
    numbers = (limits.memory_bytes, limits.processor_s, limits.max_pixels, limits.max_decoded_bytes)
    command = [sys.executable, "-I", "-B", "-c", _BEGIN, str(_ROOT), str(folder), *(str(number) for number in numbers)]
    file.seek(0)
    try:
        done = subprocess.run(  # noqa: S603 -- this program, without environment; the file is its standard input
            command, stdin=file, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, cwd=folder, env={"LANG": "C.UTF-8"},
            timeout=limits.answer_s, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return _failed("time")
    if done.returncode != 0 or len(done.stdout) > MAX_ANSWER_BYTES:
        return _failed("time" if done.returncode in (-9, -24) else "memory" if b"MemoryError" in done.stdout else "decoder_failed")
    try:
        return _read(json.loads(done.stdout))
    except (ValueError, KeyError, TypeError, AttributeError):  # no longer our program speaks
        return _failed("decoder_failed")


def _read(answer: dict[str, object]) -> ReadPhoto:
    record, derivatives = answer.get("record"), answer.get("derivatives") or {}
    if not isinstance(derivatives, dict):
        raise TypeError(derivatives)
    return ReadPhoto(
        record=record_from_json(record) if isinstance(record, dict) else None,
        width_px=_whole(answer.get("width_px")),
        height_px=_whole(answer.get("height_px")),
        derivatives={str(int(edge)): (int(size[0]), int(size[1])) for edge, size in derivatives.items()},
        fault=str(answer.get("fault", ""))[:40],
    )


def _whole(value: object) -> int | None:
    return value if isinstance(value, int) else None


def _failed(fault: str) -> ReadPhoto:
    return ReadPhoto(None, None, None, {}, fault)
