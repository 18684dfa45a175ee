"""Where numba keeps the compiled core: beside the libraries, or in the state where the checkout is read-only.

scripts/compile_core.py fills it at set-up, so that no request waits for a compiler. numba decides whether compiled code is current by the
function's own file, not by those of the functions it calls: so the folder is named by a digest of all of them, and nothing is ever read
that was compiled from other sources. Checkouts of the same sources share the code (docs/decisions/0045): paths and times do not count.
"""

import hashlib
import os
import platform
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

from config.private_servers import PROJECT_DIR, state_directory

SOURCE_FOLDERS = ("inspection/geodesy", "inspection/network", "planning")
SHIPPED = PROJECT_DIR / ".venv" / "compiled"
LOCATOR = "config.compiled.compiled_places.ProjectCacheLocator"
# Environment variables of numba that change the code, but not the names under which numba keeps it.
CODE_OPTIONS = ("NUMBA_BOUNDSCHECK", "NUMBA_DEBUGINFO", "NUMBA_ENABLE_AVX", "NUMBA_LOOP_VECTORIZE", "NUMBA_OPT", "NUMBA_SLP_VECTORIZE")
STAMP = "stamp"
STAMP_LETTERS = 16  # of it are in the folder's name


def compiled_stamp() -> str:
    """Return a digest of the sources, and of what they are compiled with and for; the same in every checkout of the same content."""
    digest = hashlib.sha256(f"{platform.python_version()} {_processor()} {_options()}".encode())
    for path in (PROJECT_DIR / "requirements.txt", PROJECT_DIR / "config" / "compiled" / "compiled_places.py"):
        digest.update(path.read_bytes())
    for folder in SOURCE_FOLDERS:
        for path in sorted((PROJECT_DIR / folder).rglob("*.py")):
            content = path.read_bytes()  # constants of any may be compiled in
            digest.update(f" {folder}/{path.relative_to(PROJECT_DIR / folder)} {len(content)} ".encode() + content)
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


def numba_settings(folder: Path) -> dict[str, str]:
    """Return the environment variables by which numba reads and writes this folder."""
    return {"NUMBA_CACHE_DIR": str(folder), "NUMBA_CACHE_LOCATOR_CLASSES": LOCATOR}


def use_compiled_directory() -> None:
    """Tell numba, before anything imports it. A NUMBA_CACHE_DIR from outside is kept."""
    if "NUMBA_CACHE_DIR" not in os.environ:
        os.environ.update(numba_settings(compiled_directory()))


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
        lines = Path("/proc/cpuinfo").read_text().partition("\n\n")[0].splitlines()
        return "".join(line for line in lines if line.startswith(("model name", "flags", "Features", "CPU part")))
    return platform.machine()


def _options() -> str:
    """What else changes the code that numba makes."""
    return " ".join(f"{name}={value}" for name, value in sorted(os.environ.items()) if name in CODE_OPTIONS)
