"""The first element of an XML document, which tells its format, and formats that only lead to data elsewhere."""

from contextlib import suppress
from typing import Any
from xml.parsers import expat

from operation.reasons import Reason

_ELSEWHERE = {
    "VRTDataset": "VRT", "OGRVRTDataSource": "VRT", "WFS_Capabilities": "WFS", "OGRWFSDataSource": "WFS", "GDAL_WMS": "WMS",
    "WMS_Capabilities": "WMS", "WMT_MS_Capabilities": "WMS", "GDAL_WMTS": "WMTS", "WCS_GDAL": "WCS",
}  # fmt: skip


class _RootFound(Exception):
    pass


def root_of(start: bytes) -> tuple[str, int]:
    """Return the name of an XML document's first element, and the line of its document type; empty and 0 where there is none."""
    parser = expat.ParserCreate()
    name, line = "", 0

    def begin(tag: str, _: dict[str, str]) -> None:
        nonlocal name
        name = tag.rpartition(":")[2]
        raise _RootFound

    def declare(*_: Any) -> None:
        nonlocal line
        line = parser.CurrentLineNumber

    parser.StartElementHandler = begin
    parser.StartDoctypeDeclHandler = declare
    with suppress(_RootFound, expat.ExpatError, LookupError, ValueError):  # the reader of the format has the words for what is wrong
        parser.Parse(start)
    return name, line


def leads_elsewhere(root: str) -> Reason | None:
    """Return why a document with this first element is refused: GDAL would open the files or servers that it names."""
    return Reason("leads_elsewhere", {"format": _ELSEWHERE[root]}) if root in _ELSEWHERE else None
