"""Files that hold pictures, documents or programs instead of data, recognised by their first bytes."""

from pathlib import Path

# as a user calls them; the browser knows the same ones (static/js/imports/kinds.js)
_SIGNATURES = (
    (b"\x89PNG\r\n\x1a\n", "PNG"), (b"\xff\xd8\xff", "JPEG"), (b"GIF8", "GIF"), (b"RIFF", "WebP, WAV or AVI"), (b"%PDF-", "PDF"),
    (b"MZ", "Windows program"), (b"\x7fELF", "Linux program"), (b"AC10", "DWG"), (b"7z\xbc\xaf\x27\x1c", "7z"), (b"Rar!", "RAR"),
)  # fmt: skip


def foreign_format(path: Path) -> str | None:
    """Return the name of the file's format if no reader takes it; None for any other file."""
    with path.open("rb") as file:
        head = file.read(8)
    return next((name for signature, name in _SIGNATURES if head.startswith(signature)), None)
