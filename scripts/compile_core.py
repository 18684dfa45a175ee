"""Compile the planners' core at set-up, so that no request waits for it; does nothing if nothing has changed.

python -m scripts.compile_core [--check | --detach]

--check only reports by its exit code whether there is nothing to do. --detach compiles in the background; a later call waits for that.

If another checkout of this user has compiled the same sources, its code is copied. Otherwise several processes compile parts in parallel.
numba's folder does not support two writers, which would give different code the same file name. So each process has its own folder, and
its additions are merged when it is done.
"""

import fcntl
import importlib
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from config.compiled.compiled_core import STAMP, compiled_directory, compiled_stamp, is_compiled, numba_settings
from scripts.installation import user_cache

POLL_S = 0.05
REPORT_INTERVAL_S = 15.0  # between two lines while another process compiles
SHARED_KIND = "compiled"


@dataclass(frozen=True)
class Part:
    """Functions that one process compiles."""

    name: str
    warm_up: tuple[str, ...]  # module:function; running them compiles what they call
    after: tuple[str, ...] = ()  # parts whose functions this one calls


# Those that take longest come first.
PARTS = (
    Part("search", ("planning.solver.warm_up:rehearse_search",)),
    Part("graph", ("inspection.network.warm_up:rehearse",)),
    Part("ways and energy", ("planning.solver.warm_up:rehearse_ways", "planning.trajectory.warm_up:rehearse"), after=("graph",)),
    Part("proofs", ("planning.solver.warm_up:rehearse_proof", "planning.file_plans:rehearse"), after=("search",)),
)
ALL = Part("whole", tuple(name for part in PARTS for name in part.warm_up))  # also compiles what two parts compiled differently


@dataclass
class _Run:
    """A part during its compilation."""

    part: Part
    folder: Path
    began_s: float
    process: subprocess.Popen[bytes]
    before: dict[Path, bytes] = field(default_factory=dict)  # numba's index files at the start


def warm_up(part: Part) -> None:
    for name in part.warm_up:
        module, _, function = name.partition(":")
        getattr(importlib.import_module(module), function)()


def compile_parts(folder: Path, processes: int) -> None:
    """Compile all parts into a folder with this many processes. Raises CalledProcessError."""
    waiting, done = list(PARTS), set[str]()
    running: list[_Run] = []
    with tempfile.TemporaryDirectory(prefix=".parts-", dir=folder.parent) as drafts:
        try:
            while waiting or running:
                for part in [part for part in waiting if done.issuperset(part.after)][: processes - len(running)]:
                    waiting.remove(part)
                    running.append(_start(part, folder, Path(drafts) / str(len(waiting))))
                for run in [run for run in running if run.process.poll() is not None]:
                    running.remove(run)
                    if run.process.returncode:
                        raise subprocess.CalledProcessError(run.process.returncode, run.part.name)
                    take_over(run.folder, run.before, folder)
                    done.add(run.part.name)
                    print(f"{run.part.name}, {len(done)} of {len(PARTS)} parts, {time.monotonic() - run.began_s:.0f} s", flush=True)
                time.sleep(POLL_S)
        finally:
            for run in running:
                run.process.kill()
                run.process.wait()
    subprocess.run(_command(ALL), env={**os.environ, **numba_settings(folder)}, check=True)


def _start(part: Part, compiled: Path, folder: Path) -> _Run:
    shutil.copytree(compiled, folder)
    process = subprocess.Popen(_command(part), env={**os.environ, **numba_settings(folder)})
    return _Run(part, folder, time.monotonic(), process, index_files(folder))


def _command(part: Part) -> list[str]:
    return [sys.executable, "-m", "scripts.compile_core", "--part", part.name]


def index_files(folder: Path) -> dict[Path, bytes]:
    """Return the content of numba's index files, by path below the folder. Each belongs to one function, and names its data files."""
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*.nbi")}


def take_over(part: Path, before: dict[Path, bytes], folder: Path) -> None:
    """Move the functions that a process has compiled into the folder, except those changed there meanwhile."""
    present = index_files(folder)
    for name, content in index_files(part).items():
        if content == before.get(name) or present.get(name) != before.get(name):
            continue
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        for path in (part / name).parent.glob(f"{name.stem}.*.nbc"):
            shutil.copy2(path, folder / name.parent / path.name)
        shutil.copy2(part / name, folder / name)


def remove_older(parent: Path) -> None:
    """Remove code compiled from older sources, except the newest, which running programs may still read."""
    older = sorted((path for path in parent.iterdir() if path.is_dir()), key=lambda path: path.stat().st_mtime)
    for path in older[:-1]:
        shutil.rmtree(path, ignore_errors=True)


def is_core_compiled() -> bool:
    return is_compiled(compiled_directory())


def compile_core() -> None:
    """Compile the core, or wait for the process that is doing so. Raises CalledProcessError."""
    parent = compiled_directory().parent
    parent.mkdir(parents=True, exist_ok=True)
    with _one_at_a_time(parent):
        if not is_core_compiled():
            _compile_or_copy(compiled_directory())


def compile_in_background() -> None:
    """Start another process that compiles the core; its output goes to a file beside the compiled code."""
    parent = compiled_directory().parent
    parent.mkdir(parents=True, exist_ok=True)
    with _log_of(parent).open("w") as log:
        subprocess.Popen([sys.executable, "-m", "scripts.compile_core"], stdin=subprocess.DEVNULL, stdout=log, stderr=log)


def _log_of(parent: Path) -> Path:
    return parent / "log"


@contextmanager
def _one_at_a_time(parent: Path) -> Iterator[None]:
    """Hold the lock of the compiled code. While another process holds it, print its last line of progress every 15 s."""
    with (parent / "lock").open("w") as lock:
        began_s = reported_s = time.monotonic()
        while not _is_locked(lock.fileno()):
            time.sleep(POLL_S)
            now_s = time.monotonic()
            if now_s - reported_s >= REPORT_INTERVAL_S:
                reported_s = now_s
                lines = _log_of(parent).read_text().splitlines() if _log_of(parent).exists() else []
                print(f"compiled by another process, {now_s - began_s:.0f} s so far{f' ({lines[-1]})' if lines else ''}", flush=True)
        yield


def _is_locked(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _compile_or_copy(folder: Path) -> None:
    remove_older(folder.parent)
    if user_cache.fetch(SHARED_KIND, folder.name, folder) and is_compiled(folder):
        print("taken from another checkout", flush=True)
        return
    stamp = compiled_stamp()
    with tempfile.TemporaryDirectory(prefix=".draft-", dir=folder.parent) as draft:
        new = Path(draft) / "new"
        new.mkdir()
        compile_parts(new, processes=max(1, os.cpu_count() or 1))
        (new / STAMP).write_text(stamp)
        shutil.rmtree(folder, ignore_errors=True)  # compiled by this checkout's programs meanwhile
        new.rename(folder)
    user_cache.publish(folder, SHARED_KIND, folder.name)


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["--part"]:
        warm_up(next(part for part in (*PARTS, ALL) if part.name == arguments[1]))
    elif is_core_compiled():
        return 0
    elif "--check" in arguments:
        return 1
    elif "--detach" in arguments:
        compile_in_background()
    else:
        compile_core()
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except subprocess.CalledProcessError as error:
        sys.exit(f"compiling failed ({error.cmd}); the reason is above")
    except KeyboardInterrupt:
        sys.exit(130)
