"""Running processes from /proc: finding those with one of our working folders, and ending them."""

import os
import signal
import subprocess
import time
from collections.abc import Iterable
from pathlib import Path

# Executables of our programs. A user's shell in one of the folders does not count.
OUR_PROGRAMS = ("postgres", "redis-server", "redis-check-rdb", "nginx", "python")


def is_alive(pid: int) -> bool:
    """Whether the process exists and is not a zombie."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text()
    except OSError:
        return False
    return fields.rpartition(")")[2].split()[0] not in {"Z", "X"}


def processes_in(folders: Iterable[Path]) -> list[int]:
    """Return the process ids of our programs whose working folder is one of these."""
    wanted = {str(folder) for folder in folders}
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit() or int(entry.name) == os.getpid():
            continue
        try:
            folder, program = str((entry / "cwd").readlink()), (entry / "exe").readlink().name
        except OSError:  # gone, or another user's
            continue
        if folder in wanted and program.removesuffix(" (deleted)").startswith(OUR_PROGRAMS) and is_alive(int(entry.name)):
            found.append(int(entry.name))
    return found


def end_processes(folders: Iterable[Path], *, first_signal: signal.Signals = signal.SIGTERM, patience_s: float = 10.0) -> int:
    """End our programs in these folders, by SIGKILL after patience_s. Returns how many there were."""
    folders = list(folders)
    seen: set[int] = set()
    deadline = time.monotonic() + patience_s
    while remaining := processes_in(folders):
        is_over = time.monotonic() > deadline
        for pid in remaining:
            if pid not in seen or is_over:
                try:
                    os.kill(pid, signal.SIGKILL if is_over else first_signal)
                except ProcessLookupError:
                    continue
        seen.update(remaining)
        time.sleep(0.05)
    return len(seen)


def end_session(process: subprocess.Popen[bytes], *, within_s: float) -> None:
    """Interrupt a process with a session of its own, so that it can stop its children; after within_s kill all of them."""
    if process.poll() is not None:
        return
    process.send_signal(signal.SIGINT)
    try:
        process.wait(within_s)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
