"""Where numba keeps the compiled core: beside the libraries, or in the state where the checkout is read-only.

scripts/compile_core.py fills it at set-up, so that no request waits for a compiler. numba asks whether what it has kept is still good
by looking at a function's own file, not at those of the functions it calls: so the folder is named by a stamp of all of them, and
nothing is ever read that was compiled from other sources.
"""

import hashlib
import os
import platform
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

from config.private_servers import PROJECT_DIR, state_directory

SOURCE_FOLDERS = ("inspection/geodesy", "inspection/graph", "missions/routing", "missions/flight_plan")
SHIPPED = PROJECT_DIR / ".venv" / "compiled"
STAMP = "stamp"
STAMP_LETTERS = 16  # of it are in the folder's name


def compiled_stamp() -> str:
    """Names the sources, as numba tells them apart, and what they are compiled with and for."""
    digest = hashlib.sha256(f"{platform.python_version()} {_processor()}".encode())
    digest.update((PROJECT_DIR / "requirements.txt").read_bytes())
    for folder in SOURCE_FOLDERS:
        for path in sorted((PROJECT_DIR / folder).glob("*.py")):
            digest.update(f"{path} {path.stat().st_mtime_ns} ".encode() + path.read_bytes())  # constants of any may be compiled in
    return digest.hexdigest()


def is_compiled(folder: Path) -> bool:
    """Whether the folder holds the core as the sources are now."""
    try:
        return (folder / STAMP).read_text() == compiled_stamp()
    except OSError:
        return False


def compiled_directory() -> Path:
    """The folder to read and write, which numba does only where it may write."""
    name = compiled_stamp()[:STAMP_LETTERS]
    if os.access(SHIPPED if SHIPPED.exists() else SHIPPED.parent, os.W_OK):
        return SHIPPED / name
    own = state_directory() / "compiled" / name
    if not is_compiled(own) and is_compiled(SHIPPED / name):
        with suppress(OSError):
            _copy(SHIPPED / name, own)
    return own


def use_compiled_directory() -> None:
    """Tell numba, before anything imports it. A NUMBA_CACHE_DIR from outside is kept."""
    if "NUMBA_CACHE_DIR" not in os.environ:
        os.environ["NUMBA_CACHE_DIR"] = str(compiled_directory())


def _copy(source: Path, target: Path) -> None:
    """Put a copy where the target is; of several processes that do so at a time one wins."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".compiled-", dir=target.parent) as draft:
        shutil.copytree(source, Path(draft) / "new")
        if target.exists():
            target.rename(Path(draft) / "old")
        (Path(draft) / "new").rename(target)


def _processor() -> str:
    if named := os.environ.get("NUMBA_CPU_NAME"):  # an image is compiled for every processor of a level, not for the one at hand
        return f"{named} {os.environ.get('NUMBA_CPU_FEATURES', 'of its own')}"
    with suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line
    return platform.machine()
