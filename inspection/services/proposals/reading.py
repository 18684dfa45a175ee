"""Result of reading a file for a proposal, common to all kinds of data."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any, Protocol

from django.contrib.gis.geos import GEOSGeometry

from inspection.auto_apply_hooks import AutoApplyRefusal
from inspection.models import ChangeAction, DataImport, ImportKind
from operation.reasons import Reason
from workspace.models import User

Progress = Callable[[Reason, float], None]
"""Told the stage and the share of the whole, 0 to 1. May raise JobCancelled: then nothing is written."""


@dataclass(frozen=True)
class Change:
    """One line of a difference. before and after hold the facts that differ, geometries as GeoJSON."""

    action: ChangeAction
    subject: str  # an asset kind, or "zone"
    label: str
    subject_id: int | None = None
    geometry: GEOSGeometry | None = None
    before: dict[str, Any] | None = None
    after: dict[str, Any] | None = None
    key: str = ""  # names the row in the difference, to leave it out


def excluded_of(parameters: Mapping[str, Any]) -> list[str]:
    """Return the keys of the changes that the applying user leaves out."""
    stated = parameters.get("excluded")
    return [key for key in stated if isinstance(key, str)] if isinstance(stated, list) else []


@dataclass(frozen=True)
class Fault:
    """A reason to refuse a file, with its place. position is lon, lat [deg]."""

    place: str
    message: Reason | str
    position: tuple[float, float] | None = None


class FileRefused(ValueError):
    """Raised for a file with faults; none of it counts. `are_of_records`: it can be read without the records that have them."""

    def __init__(self, faults: Iterable[Fault], *, are_of_records: bool = False) -> None:
        self.faults = tuple(faults)
        self.are_of_records = are_of_records
        super().__init__("; ".join(f"{fault.place}: {fault.message}" if fault.place else str(fault.message) for fault in self.faults))


@dataclass(frozen=True)
class Provenance:
    """The source of a file, as far as the file does not state it."""

    file_name: str
    source_address: str = ""
    licence: str = ""
    attribution: str = ""
    fetched_at: datetime | None = None
    organisation_id: int | None = None  # owner of the file and of its ids

    @property
    def of_import(self) -> dict[str, Any]:
        """Return the fields of a DataImport."""
        return {name: getattr(self, name) for name in ("attribution", "licence", "source_address", "fetched_at")}


@dataclass
class Reading:
    """Content of a file and its changes. changes may be cut after the first few thousand; numbers cover all."""

    summary: dict[str, Any]  # content of the file; names include units
    numbers: dict[str, int]  # by ChangeAction, and "unchanged"
    changes: Iterable[Change] = field(default_factory=tuple)


class FileKind(Protocol):
    """Functions to read and apply one kind of data: a module of this package for each ImportKind has these two.

    path is None for data without a file, such as the roll-back of a zone set.
    """

    def read(self, *, path: Path | None, parameters: dict[str, Any], provenance: Provenance, progress: Progress) -> Reading:
        """Return the file's content and changes; writes nothing permanent. Raises FileRefused."""

    def apply(
        self, *, path: Path | None, parameters: dict[str, Any], provenance: Provenance, applied_by: User | None, progress: Progress
    ) -> DataImport:
        """Update the map data to the file, in the caller's transaction. Raises FileRefused."""


KINDS = (ImportKind.OSM, ImportKind.ZONES, ImportKind.ASSETS)  # terrain affects everything, so a user reviews it
_KNOWN = ("changed", "vanished", "kept", "unchanged")  # rows that the source had before


def reasons_against(numbers: Mapping[str, int], content: Mapping[str, Any], max_removed_percent: float) -> list[AutoApplyRefusal]:
    """Return the reasons for which a difference needs a review.

    numbers are of all changes by action; content is what was read, including unreadable records.
    """
    reasons = []
    if content.get("needs_mapping"):
        reasons.append(AutoApplyRefusal("needs_mapping", Reason("columns_not_explained")))
    not_read = len(content.get("not_read", ())) + content.get("faulty_rows_left_out", 0)
    if not_read:
        reasons.append(AutoApplyRefusal("not_read", Reason("records_left_out", {"number": not_read})))
    if unread_values := sum(content.get("unread_values", {}).values()):
        reasons.append(AutoApplyRefusal("not_read", Reason("values_unread", {"number": unread_values})))
    removed, known = numbers.get("vanished", 0), sum(numbers.get(action, 0) for action in _KNOWN)
    if removed * 100.0 > max_removed_percent * known:
        percent = float(f"{removed * 100.0 / known:.3g}")
        figures = {"removed": removed, "known": known, "percent": percent, "limit": max_removed_percent}
        reasons.append(AutoApplyRefusal("removed", Reason("removes_too_many", figures)))
    return reasons
