"""GDAL in a process of its own, with one named driver and limits: files from elsewhere can crash it, but not its caller."""

import json
import os
import resource
import select
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from ctypes.util import find_library
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import IO, Any

from operation.reasons import Reason

_ROOT = Path(__file__).resolve().parents[2]
_BEGIN = "import sys; sys.path.append(sys.argv[1]); from inspection.importers.gdal_child.program import main; main()"
_CHUNK = 256 * 1024
MAX_LINE_BYTES = 16 * 1024 * 1024


class GdalRefusal(ValueError):
    """Raised for a file that the child does not read, with the reason for users."""

    def __init__(self, reason: Reason | str) -> None:
        self.reason = reason
        super().__init__(str(reason))


@dataclass(frozen=True)
class GdalLimits:
    """Limits of the child. answer_s: of the wall clock, for one answer."""

    memory_mib: int = 512  # of addresses, 200 MiB of which are libraries
    processor_s: int = 1
    processor_s_per_mib: float = 3.0  # of the file, as for reading it here
    most_processor_s: int = 600
    answer_s: float = 60.0

    def processor_limit_s(self, size_bytes: int) -> int:
        return min(self.processor_s + int(self.processor_s_per_mib * size_bytes / 2**20), self.most_processor_s)


LIMITS = GdalLimits()


class GdalProcess:
    """A running child. files: by the names under which it finds them, all in one folder without anything else."""

    def __init__(self, driver: str, files: Mapping[str, IO[bytes]], limits: GdalLimits, **job: Any) -> None:
        self._limits = limits
        self._folder = tempfile.TemporaryDirectory(prefix="gdal-")
        folder = Path(self._folder.name)
        for name, file in files.items():
            link = folder / name
            link.parent.mkdir(exist_ok=True)
            link.symlink_to(f"/proc/self/fd/{file.fileno()}")
        size_bytes = sum(os.fstat(file.fileno()).st_size for file in files.values())
        self._limit_s = limits.processor_limit_s(size_bytes)
        self._buffer = bytearray()
        self._process = subprocess.Popen(  # noqa: S603 -- this program, isolated: no site packages, environment or working folder
            [sys.executable, "-I", "-S", "-B", "-c", _BEGIN, str(_ROOT)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, pass_fds=[file.fileno() for file in files.values()], cwd=folder, bufsize=0,
            env={"LANG": "C.UTF-8", "TMPDIR": str(folder)},
        )  # fmt: skip
        self._job = {
            "library": _library(), "driver": driver, "path": str(folder / next(iter(files)).split("/")[0]),
            "memory_bytes": limits.memory_mib * 2**20, "processor_s": self._limit_s, "most_processor_s": limits.most_processor_s, **job,
        }  # fmt: skip

    def begin(self) -> None:
        self.ask(self._job)

    def ask(self, question: Any) -> None:
        assert self._process.stdin is not None  # noqa: S101
        try:
            self._process.stdin.write(json.dumps(question).encode() + b"\n")
        except BrokenPipeError as error:
            raise self._end() from error

    def line(self) -> Any:
        """Return the next answer. Raises GdalRefusal."""
        while (end := self._buffer.find(b"\n")) < 0:
            if len(self._buffer) > MAX_LINE_BYTES:
                raise GdalRefusal(Reason("reader_memory", {"mib": self._limits.memory_mib}))
            self._receive()
        try:
            answer = json.loads(self._buffer[:end])
        except (ValueError, RecursionError) as error:  # no longer our program speaks
            raise GdalRefusal(Reason("reader_ended", {"mib": self._limits.memory_mib})) from error
        del self._buffer[: end + 1]
        if isinstance(answer, dict) and "unreadable" in answer:
            raise GdalRefusal(answer["unreadable"])
        if isinstance(answer, dict) and "out_of_memory" in answer:
            raise GdalRefusal(Reason("reader_memory", {"mib": self._limits.memory_mib}))
        return answer

    def data(self, size_bytes: int) -> bytes:
        """Return that many bytes after a line. Raises GdalRefusal."""
        while len(self._buffer) < size_bytes:
            self._receive()
        found = bytes(self._buffer[:size_bytes])
        del self._buffer[:size_bytes]
        return found

    def allow_processor(self, seconds: int) -> None:
        """Raise the limit of the child's processor time."""
        self._limit_s = min(self._limit_s + seconds, self._limits.most_processor_s)
        try:
            resource.prlimit(self._process.pid, resource.RLIMIT_CPU, (self._limit_s, self._limits.most_processor_s))
        except ProcessLookupError:
            return

    def close(self) -> None:
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()
        self._folder.cleanup()

    def _receive(self) -> None:
        assert self._process.stdout is not None  # noqa: S101
        ready = select.poll()
        ready.register(self._process.stdout, select.POLLIN)
        if not ready.poll(self._limits.answer_s * 1_000):
            raise GdalRefusal(Reason("reader_time", {"seconds": round(self._limits.answer_s)}))
        chunk = os.read(self._process.stdout.fileno(), _CHUNK)
        if not chunk:
            raise self._end()
        self._buffer += chunk

    def _end(self) -> GdalRefusal:
        """Return why the child ended without an answer."""
        ended = self._process.wait()
        if ended in (-signal.SIGXCPU, -signal.SIGKILL):
            return GdalRefusal(Reason("reader_time", {"seconds": self._limit_s}))
        return GdalRefusal(Reason("reader_ended", {"mib": self._limits.memory_mib}))


def started(driver: str, files: Mapping[str, IO[bytes]], limits: GdalLimits = LIMITS, **job: Any) -> GdalProcess:
    """Start a child that reads the first of the files, or the folder that it is in; its caller closes it. Raises GdalRefusal."""
    process = GdalProcess(driver, files, limits, **job)
    try:
        process.begin()
    except GdalRefusal:
        process.close()
        raise
    return process


@contextmanager
def gdal_process(driver: str, files: Mapping[str, IO[bytes]], limits: GdalLimits = LIMITS, **job: Any) -> Iterator[GdalProcess]:
    """Start a child and close it. Raises GdalRefusal."""
    process = started(driver, files, limits, **job)
    try:
        yield process
    finally:
        process.close()


@cache
def _library() -> str:
    found = find_library("gdal")
    if found is None:
        raise OSError("libgdal is not installed; scripts/setup installs it")
    return found
