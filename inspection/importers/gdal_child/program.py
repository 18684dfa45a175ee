"""The child: reads one file for its parent, which may be hostile, and answers with lines of JSON on its standard output.

Its job is the first line of its standard input; see gdal_process.py for the other side.
"""

import json
import sys
from typing import Any

from inspection.importers.gdal_child.features import report_features
from inspection.importers.gdal_child.heights import Windows, described
from inspection.importers.gdal_child.libgdal import Gdal, Unreadable
from inspection.importers.gdal_child.limits import set_limits


def main() -> None:
    job = json.loads(sys.stdin.buffer.readline())
    try:
        gdal = Gdal(job["library"], job["driver"])
        set_limits(job["memory_bytes"], job["processor_s"], job["most_processor_s"])
        try:
            _do(gdal, job)
        except Unreadable as error:
            _report({"unreadable": str(error).replace(job["path"], "the file")[:300]})
    except MemoryError:
        _report({"out_of_memory": True})
    sys.stdout.buffer.flush()


def _do(gdal: Gdal, job: dict[str, Any]) -> None:
    data_set = gdal.open(job["path"])
    if job["driver"] == "GTiff":
        _serve_windows(gdal, data_set, job["path"])
    else:
        report_features(gdal, data_set, job["layer"], job["most"], _report)


def _serve_windows(gdal: Gdal, data_set: Any, path: str) -> None:
    """Answer each window that is asked for: a line with the absent parts, then the values."""
    _report(described(gdal, data_set))
    sys.stdout.buffer.flush()
    windows = None
    while line := sys.stdin.buffer.readline():
        windows = windows or Windows(gdal, data_set, path)
        window = json.loads(line)
        values = windows.values(*window)
        _report({"absent": windows.absent(*window)})
        sys.stdout.buffer.write(values)
        sys.stdout.buffer.flush()


def _report(answer: Any) -> None:
    sys.stdout.buffer.write(json.dumps(answer, separators=(",", ":")).encode() + b"\n")
