"""The accepted kinds of files, detected from their first bytes; file names and browsers' types are ignored."""

from dataclasses import dataclass

HEAD_BYTES = 32  # enough to detect every kind


@dataclass(frozen=True)
class MediaType:
    """A kind of file. pillow_formats: with which Pillow may read it; empty where nothing here decodes it."""

    name: str
    suffixes: tuple[str, ...]
    is_video: bool = False
    pillow_formats: tuple[str, ...] = ()


JPEG = MediaType("image/jpeg", (".jpg", ".jpeg"), pillow_formats=("JPEG",))
PNG = MediaType("image/png", (".png",), pillow_formats=("PNG",))
TIFF = MediaType("image/tiff", (".tif", ".tiff", ".dng"), pillow_formats=("TIFF",))
WEBP = MediaType("image/webp", (".webp",), pillow_formats=("WEBP",))
HEIC = MediaType("image/heic", (".heic", ".heif"))
MP4 = MediaType("video/mp4", (".mp4", ".m4v"), is_video=True)
MOV = MediaType("video/quicktime", (".mov",), is_video=True)
MEDIA_TYPES = {found.name: found for found in (JPEG, PNG, TIFF, WEBP, HEIC, MP4, MOV)}

_HEIF_BRANDS = {b"heic", b"heix", b"heim", b"heis", b"hevc", b"hevx", b"mif1", b"msf1"}
_MP4_BRANDS = {b"isom", b"iso2", b"iso4", b"iso5", b"iso6", b"mp41", b"mp42", b"avc1", b"M4V ", b"MSNV", b"dash"}


def media_type_of(head: bytes) -> MediaType | None:
    """Return the kind of a file that begins with these bytes; None for one that is not taken."""
    if head.startswith(b"\xff\xd8\xff"):
        return JPEG
    if head.startswith(b"\x89PNG\r\n\x1a\n"):
        return PNG
    if head.startswith((b"II*\0", b"MM\0*")):
        return TIFF
    if head[:4] == b"RIFF" and head[8:12] == b"WEBP":
        return WEBP
    if head[4:8] == b"ftyp":
        brand = head[8:12]
        return HEIC if brand in _HEIF_BRANDS else MOV if brand == b"qt  " else MP4 if brand in _MP4_BRANDS else None
    return None


def name_with_suffix(file_name: str, media_type: MediaType) -> str:
    """Return a file name that ends as files of its kind do."""
    return file_name if file_name.lower().endswith(media_type.suffixes) else file_name + media_type.suffixes[0]
