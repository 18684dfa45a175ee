"""Location of numba's compiled core: beside the libraries, or in the state folder where the checkout is read-only.

scripts/compile_core.py fills it at set-up, so that no request waits for a compiler. numba checks compiled code against the function's own
file only, not those of the functions it calls. So a digest of all sources names the folder, and code compiled from other sources is never
read. Checkouts of the same sources share the code (docs/decisions/0045): paths and times do not count.
"""

import hashlib
import os
import platform
import re
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

from config.private_servers import PROJECT_DIR, state_directory

SOURCE_FOLDERS = ("inspection/geodesy", "inspection/network", "planning")
SHIPPED = PROJECT_DIR / ".venv" / "compiled"
COMPILER_LIBRARIES = ("cffi", "llvmlite", "numba", "numpy", "scipy")
LOCATOR = "config.compiled.compiled_places.ProjectCacheLocator"
# Environment variables of numba that change the code, but not the names under which numba stores it.
CODE_OPTIONS = ("NUMBA_BOUNDSCHECK", "NUMBA_DEBUGINFO", "NUMBA_ENABLE_AVX", "NUMBA_LOOP_VECTORIZE", "NUMBA_OPT", "NUMBA_SLP_VECTORIZE")
STAMP = "stamp"
STAMP_LETTERS = 16  # of the digest, in the folder's name


def compiled_stamp() -> str:
    """Return a digest of the sources, compiler options and target; the same in every checkout of the same content."""
    digest = hashlib.sha256(f"{platform.python_version()} {_processor()} {_options()}".encode())
    digest.update(" ".join(compiler_versions((PROJECT_DIR / "requirements.txt").read_text())).encode())
    digest.update((PROJECT_DIR / "config" / "compiled" / "compiled_places.py").read_bytes())
    for folder in SOURCE_FOLDERS:
        for path in sorted((PROJECT_DIR / folder).rglob("*.py")):
            content = path.read_bytes()  # constants of any file may be compiled in
            digest.update(f" {folder}/{path.relative_to(PROJECT_DIR / folder)} {len(content)} ".encode() + content)
    return digest.hexdigest()


def compiler_versions(requirements: str) -> list[str]:
    """Return the pinned libraries that decide what is compiled, such as "numba==0.61.0"; others change without a new core."""
    return re.findall(rf"^(?:{'|'.join(COMPILER_LIBRARIES)})==[^\s\\]+", requirements, re.M)


def is_compiled(folder: Path) -> bool:
    """Whether the folder holds the core of the current sources."""
    try:
        return (folder / STAMP).read_text() == compiled_stamp()
    except OSError:
        return False


def compiled_directory() -> Path:
    """Return the folder to read and write; numba reads only from a writable one."""
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
    """Configure numba before its first import. An existing NUMBA_CACHE_DIR is kept."""
    if "NUMBA_CACHE_DIR" not in os.environ:
        os.environ.update(numba_settings(compiled_directory()))


def _copy(source: Path, target: Path) -> None:
    """Copy a folder to the target; of several concurrent processes one wins."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".compiled-", dir=target.parent) as draft:
        shutil.copytree(source, Path(draft) / "new")
        if target.exists():
            target.rename(Path(draft) / "old")
        (Path(draft) / "new").rename(target)


def _processor() -> str:
    if named := os.environ.get("NUMBA_CPU_NAME"):  # an image is compiled for all processors of a level
        return f"{named} {os.environ.get('NUMBA_CPU_FEATURES', 'of its own')}"
    with suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text().partition("\n\n")[0].splitlines()
        return "".join(line for line in lines if line.startswith(("model name", "flags", "Features", "CPU part")))
    return platform.machine()


def _options() -> str:
    """Return other options that change numba's code."""
    return " ".join(f"{name}={value}" for name, value in sorted(os.environ.items()) if name in CODE_OPTIONS)
