"""Safe reading of zip files: no bombs, paths, links or nested archives; unpacked files have no name on disk."""

import io
import stat
import tempfile
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from inspection.importers.rows import refused

MAX_ENTRIES = 1_000
MAX_DIRECTORY_BYTES = 256 * 1024  # what zipfile reads at once; one entry takes 46 bytes and its name
MAX_UNPACKED_BYTES = 512 * 1024 * 1024
MAX_RATIO = 100  # real shapefiles and KML compress 3:1 to 30:1
FREE_UNPACKED_BYTES = 4 * 1024 * 1024  # below this size any ratio is accepted
_CHUNK = 64 * 1024
_ARCHIVE_ENDINGS = (".zip", ".kmz", ".gz", ".bz2", ".xz", ".7z", ".rar", ".tar", ".tgz")
_METHODS = {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}
_ENCRYPTED = 0x1


class _TooMuchAtOnce(Exception):
    pass


class _CappedFile(io.BufferedReader):
    """Refuses reads larger than a plausible directory of entries: a hostile one would fill the memory with its names."""

    def read(self, size: int | None = -1, /) -> bytes:
        wanted = MAX_DIRECTORY_BYTES + 1 if size is None or size < 0 else size
        if wanted > MAX_DIRECTORY_BYTES + 1:
            raise _TooMuchAtOnce
        data = super().read(wanted)
        if len(data) > MAX_DIRECTORY_BYTES:
            raise _TooMuchAtOnce
        return data


class Archive:
    """The files of a zip file by name; a member is unpacked into an unnamed temporary file."""

    def __init__(self, archive: zipfile.ZipFile, packed_bytes: int, most_ratio: int) -> None:
        self._archive = archive
        self.packed_bytes = packed_bytes
        self._most_ratio = most_ratio
        self._unpacked = 0
        self.names = [info.filename for info in archive.infolist() if not info.is_dir()]

    def size_of(self, name: str) -> int:
        """Return the unpacked size as the archive states it; extraction never exceeds it."""
        return self._archive.getinfo(name).file_size

    @contextmanager
    def unpacked(self, name: str) -> Iterator[IO[bytes]]:
        with tempfile.TemporaryFile() as file:
            try:
                with self._archive.open(name) as member:
                    while chunk := member.read(_CHUNK):
                        self._count(len(chunk), name)
                        file.write(chunk)
            except (zipfile.BadZipFile, zlib.error, EOFError, OSError, NotImplementedError, _TooMuchAtOnce) as error:
                raise refused(name, f"it cannot be unpacked: {error or 'the entry is damaged'}") from error
            file.seek(0)
            yield file

    def text(self, name: str, most_bytes: int) -> str:
        """Return the text of a small member, such as the one that names the reference system."""
        with self.unpacked(name) as file:
            data = file.read(most_bytes + 1)
        if len(data) > most_bytes:
            raise refused(name, f"it has more than {most_bytes} bytes")
        return data.decode("utf-8-sig", errors="replace")

    def _count(self, size: int, name: str) -> None:
        self._unpacked += size
        if self._unpacked > FREE_UNPACKED_BYTES and self._unpacked > self._most_ratio * self.packed_bytes:
            raise refused(name, f"the archive unpacks to more than {self._most_ratio} times its size; refused as a decompression bomb")
        if self._unpacked > MAX_UNPACKED_BYTES:
            raise refused(name, f"the archive unpacks to more than {MAX_UNPACKED_BYTES // 2**20} MiB")


@contextmanager
def opened_archive(path: Path, *, most_ratio: int = MAX_RATIO) -> Iterator[Archive]:
    """Open an archive. most_ratio: largest ratio of unpacked to packed size. Raises AssetFileError for an implausible archive."""
    with path.open("rb", buffering=0) as raw, _CappedFile(raw) as file:
        try:
            archive = zipfile.ZipFile(file)
        except _TooMuchAtOnce as error:
            raise refused("", f"the archive has far more than {MAX_ENTRIES} entries") from error
        except (zipfile.BadZipFile, NotImplementedError, OSError, ValueError) as error:
            raise refused("", f"the archive is damaged or cut off: {error}") from error
        with archive:
            _check_entries(archive.infolist())
            yield Archive(archive, path.stat().st_size, most_ratio)


def _check_entries(entries: list[zipfile.ZipInfo]) -> None:
    if len(entries) > MAX_ENTRIES:
        raise refused("", f"the archive has {len(entries)} entries; at most {MAX_ENTRIES} are taken")
    seen: set[str] = set()
    for entry in entries:
        name = entry.filename
        if fault := _fault_of(entry):
            raise refused(name[:200], fault)
        if name in seen:
            raise refused(name[:200], "the archive has two entries of this name")
        seen.add(name)


def _fault_of(entry: zipfile.ZipInfo) -> str | None:
    stated: Any = entry.orig_filename
    parts = stated.replace("\\", "/").split("/")
    if stated.startswith(("/", "\\")) or ".." in parts or ":" in parts[0] or "\0" in stated:
        return "an entry's path leads out of the archive"
    if stat.S_ISLNK(entry.external_attr >> 16):
        return "an entry is a symbolic link"
    if entry.flag_bits & _ENCRYPTED:
        return "the archive is encrypted; send it without a password"
    if stated.lower().endswith(_ARCHIVE_ENDINGS):
        return "there is an archive in the archive; unpack it and send the inner one"
    if entry.compress_type not in _METHODS:
        return "an entry is packed with another method than deflate"
    if entry.file_size > MAX_UNPACKED_BYTES:
        return f"an entry unpacks to more than {MAX_UNPACKED_BYTES // 2**20} MiB"
    return None
