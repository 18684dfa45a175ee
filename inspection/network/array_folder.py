"""Arrays as a folder of memory-mapped files that is there whole or not at all."""

import json
import os
import shutil
import tempfile
from hashlib import file_digest
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

MANIFEST = "manifest.json"

Arrays = dict[str, Any]  # NumPy arrays by the names of their files


def write_folder(parent: Path, name: str, arrays: Arrays, about: dict[str, Any], *, kept: int) -> None:
    """One .npy file per array in parent/name, and the manifest with their hashes and what they are about (JSON).

    All appears whole or not at all, in place of a folder that is broken. Beside it the `kept` folders used last stay.
    """
    parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".draft-", dir=parent) as draft_name:
        draft = Path(draft_name) / "arrays"
        draft.mkdir()
        for array_name, array in arrays.items():
            np.save(draft / f"{array_name}.npy", array, allow_pickle=False)
        hashes = {path.name: _hash_of_file(path) for path in sorted(draft.iterdir())}
        (draft / MANIFEST).write_text(json.dumps({"about": about, "files": hashes}))
        target = parent / name
        try:
            draft.rename(target)
        except OSError:  # there is one already: a broken one, or another process was faster with the same
            target.rename(Path(draft_name) / "replaced")
            draft.rename(target)
    _remove_old(parent, but=name, kept=kept)


def read_folder(place: Path, about: dict[str, Any]) -> Arrays | None:
    """The arrays, memory-mapped and read-only; None when files are missing, broken or about something else."""
    try:
        manifest = json.loads((place / MANIFEST).read_bytes())
        if manifest["about"] != about:
            return None
        if any(_hash_of_file(place / name) != digest for name, digest in manifest["files"].items()):
            return None
        # Files with the same content are mapped once: where the cost of an edge is its length, half of the index is.
        mapped = {digest: _mapped(place / name) for name, digest in manifest["files"].items()}
        if json.loads((place / MANIFEST).read_bytes()) != manifest:  # others took the place between the look and the mapping
            return None
        os.utime(place)
        return {name.removesuffix(".npy"): mapped[digest] for name, digest in manifest["files"].items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def _mapped(path: Path) -> NDArray[np.generic]:
    mapped = np.load(path, mmap_mode="r", allow_pickle=False)
    plain: NDArray[np.generic] = np.asarray(mapped)
    return plain


def _hash_of_file(path: Path) -> str:
    with path.open("rb") as file:
        return file_digest(file, "sha256").hexdigest()


def _remove_old(parent: Path, *, but: str, kept: int) -> None:
    """Keep what was used last, and this one; remove drafts that killed processes left before any of it."""
    folders = sorted((path for path in parent.iterdir() if path.is_dir() and not path.name.startswith(".")), key=_used_s, reverse=True)
    for path in folders[kept:]:
        if path.name != but:
            shutil.rmtree(path, ignore_errors=True)
    oldest_s = min((_used_s(path) for path in folders[:kept]), default=0.0)
    for path in parent.glob(".draft-*"):
        if _used_s(path) < oldest_s:
            shutil.rmtree(path, ignore_errors=True)


def _used_s(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except FileNotFoundError:
        return float("inf")
