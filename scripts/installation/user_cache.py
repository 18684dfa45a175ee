"""A cache folder that this user's checkouts on a machine share: compiled code, and the program that installs libraries.

Its content is executed, so the folder is used only if it belongs to this user and no other user can write to it. An entry is a folder that
is created complete by one rename, and never changed afterwards.
"""

import os
import shutil
import stat
import tempfile
import time
from contextlib import suppress
from pathlib import Path

MAX_AGE_S = 60 * 86_400.0  # entries unused for this long are removed
MAX_ENTRIES = 6  # of a kind; compiled code is 25 MB


def user_cache() -> Path | None:
    """Return the folder, created if missing; None where no safe one is possible, so that nothing is shared."""
    try:
        base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
        folder = Path(base) / "spanwise"
        if not folder.is_absolute():
            return None
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        found = folder.lstat()
    except (OSError, RuntimeError):  # no home, or not writable
        return None
    is_safe = stat.S_ISDIR(found.st_mode) and found.st_uid == os.geteuid() and not found.st_mode & 0o022
    return folder if is_safe and os.access(folder, os.W_OK) else None


def fetch(kind: str, name: str, target: Path) -> bool:
    """Replace the target by a copy of an entry; returns False if there is none."""
    cache = user_cache()
    entry = cache / kind / name if cache else None
    if entry is None or not entry.is_dir():
        return False
    try:
        with suppress(OSError):
            os.utime(entry)  # mark it as used
        _copy(entry, target)
    except OSError:  # removed meanwhile, or the disk is full
        return False
    return True


def publish(source: Path, kind: str, name: str) -> None:
    """Copy a folder to the cache, and remove entries of its kind that are old or too many. A failure is ignored."""
    cache = user_cache()
    if cache is None:
        return
    with suppress(OSError):
        entry = cache / kind / name
        if not entry.exists():
            _copy(source, entry)
            os.utime(entry)
        _prune(entry)


def _copy(source: Path, target: Path) -> None:
    """Copy to a draft beside the target, then rename it over the target. Of several concurrent copies one wins."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".draft-", dir=target.parent) as draft:
        shutil.copytree(source, Path(draft) / "new")
        if target.exists():
            target.rename(Path(draft) / "old")
        (Path(draft) / "new").rename(target)


def _prune(newest: Path) -> None:
    """Remove other entries that are unused for long or beyond the limit, and drafts of interrupted copies."""
    now = time.time()
    others = []
    for entry in newest.parent.iterdir():
        with suppress(OSError):
            age_s = now - entry.stat().st_mtime
            if entry.name.startswith("."):
                if age_s > 86_400.0:
                    shutil.rmtree(entry, ignore_errors=True)
            elif entry != newest:
                others.append((age_s, entry))
    for place, (age_s, entry) in enumerate(sorted(others), start=1):
        if age_s > MAX_AGE_S or place >= MAX_ENTRIES:
            shutil.rmtree(entry, ignore_errors=True)
