"""HGT files as they are handed out: zipped, one in each."""

import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory

from inspection.terrain.errors import TerrainFileError

MOST_MEMBERS = 20
_SIZES = {1201 * 1201 * 2, 3601 * 3601 * 2}
_CHUNK = 1024 * 1024


@contextmanager
def unpacked_hgt(path: Path) -> Iterator[Path]:
    """The only .hgt file of a zip, under its own name, gone afterwards. Raises TerrainFileError."""
    with TemporaryDirectory() as folder:
        try:
            with zipfile.ZipFile(path) as archive:
                members = archive.infolist()
                if len(members) > MOST_MEMBERS:
                    raise TerrainFileError(f"The zip has {len(members)} members; a zipped HGT file has one.")
                files = [member for member in members if member.filename.lower().endswith(".hgt")]
                if len(files) != 1:
                    raise TerrainFileError(f"The zip has {len(files)} HGT files; send each by itself.")
                if files[0].file_size not in _SIZES:
                    raise TerrainFileError("The HGT file in the zip has not 1201 or 3601 posts a side.")
                target = Path(folder) / PurePosixPath(files[0].filename.replace("\\", "/")).name
                _unpack(archive, files[0], target)
        except (zipfile.BadZipFile, RuntimeError, NotImplementedError, EOFError, ValueError) as error:
            if isinstance(error, TerrainFileError):
                raise
            raise TerrainFileError("The zip is damaged, encrypted, or packed in a way that is not known.") from error
        yield target


def _unpack(archive: zipfile.ZipFile, member: zipfile.ZipInfo, target: Path) -> None:
    """Never more than the member says that it has."""
    left = member.file_size
    with archive.open(member) as packed, target.open("wb") as file:
        while chunk := packed.read(_CHUNK):
            left -= len(chunk)
            if left < 0:
                raise TerrainFileError("The zip unpacks to more than it says.")
            file.write(chunk)
