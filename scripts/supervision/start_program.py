"""Become one of the supervised programs: end leftovers of an earlier instance, exit with the supervisor, exec.

python -m scripts.supervision.start_program FOLDER [--user NAME] [--stale FILE]... [--stop-signal NAME] -- COMMAND...

A server ended by SIGKILL leaves its workers behind, which still hold the port or the data folder; they are found by their working
folder, which belongs to this program only. If the supervisor itself is killed, the kernel sends the program its stop signal
(PR_SET_PDEATHSIG), so that nothing outlives it.
"""

import argparse
import ctypes
import os
import pwd
import resource
import signal
from pathlib import Path

from scripts.supervision.processes import end_processes

PR_SET_PDEATHSIG = 1  # linux/prctl.h


def remove_stale_lock(path: Path) -> None:
    """Remove a lock file of a dead server. Its process id may be in use again, so the server's own test is not sufficient."""
    try:
        path.unlink()
    except FileNotFoundError:
        return
    print(f"removed {path.name}, which a killed server left behind", flush=True)


def _become(user: str) -> None:
    entry = pwd.getpwnam(user)
    os.setgroups([])
    os.setgid(entry.pw_gid)
    os.setuid(entry.pw_uid)
    os.environ["HOME"] = entry.pw_dir


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--user")
    parser.add_argument("--stale", type=Path, action="append", default=[])
    parser.add_argument("--stop-signal", default="TERM", help="ends leftovers; sent by the kernel when the supervisor dies")
    parser.add_argument("command", nargs="+")
    options = parser.parse_args()

    supervisor = os.getppid()
    stop_signal = signal.Signals[f"SIG{options.stop_signal}"]
    ended = end_processes([options.folder], first_signal=stop_signal, patience_s=5.0)
    if ended:
        print(f"ended {ended} processes that a killed server left behind", flush=True)
    for path in options.stale:
        remove_stale_lock(path)
    os.chdir(options.folder)
    if options.user:
        _become(options.user)
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(PR_SET_PDEATHSIG, stop_signal, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "prctl(PR_SET_PDEATHSIG)")
    if os.getppid() != supervisor:
        raise SystemExit("the supervisor has gone")
    files, most_files = resource.getrlimit(resource.RLIMIT_NOFILE)
    if files < most_files:  # a thousand open pages need a thousand files
        resource.setrlimit(resource.RLIMIT_NOFILE, (most_files, most_files))
    os.execvp(options.command[0], options.command)  # noqa: S606 - no shell, the command is the supervisor's


if __name__ == "__main__":
    main()
