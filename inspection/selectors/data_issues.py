"""Data issues as a list, worst first, and their number by kind."""

from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING

from django.contrib.gis.db.models.functions import AsGeoJSON
from django.db.models import Count, QuerySet

from inspection.models import DataIssue, DataIssueKind, DataIssueSearch, DataIssueState
from inspection.selectors.assets import COORDINATE_DIGITS, AsDrawn, Box, area_of, assets_on_the_ground

if TYPE_CHECKING:
    from django_stubs_ext import WithAnnotations

    DrawnIssue = WithAnnotations[DataIssue, AsDrawn]
else:
    DrawnIssue = DataIssue
WORST_FIRST = ("-cut_off_m", "pk")
_UNREAD = [
    f"{path}__{name}"
    for path in ("asset", "other_asset", "asset__line", "other_asset__line")
    for name in ("geometry", "node_osm_ids", "tags", "parts", "source_facts")
]


@dataclass(frozen=True)
class DataIssueSummary:
    counts: dict[str, dict[str, int]]  # by kind, then by state
    searched_at: datetime | None
    found: int


def issues(
    *, kinds: list[DataIssueKind] | None = None, state: DataIssueState | None = None, box: Box | None = None, text: str = ""
) -> QuerySet[DrawnIssue]:
    """Return data issues with their assets, and their geometry as GeoJSON text in `geometry_json`."""
    found = DataIssue.objects.select_related("asset__line", "other_asset__line", "decided_by")
    if kinds:
        found = found.filter(kind__in=kinds)
    if state is not None:
        found = found.filter(state=state)
    if box is not None:
        found = found.filter(geometry__intersects=area_of(box))
    if text:
        found = found.filter(asset__in=assets_on_the_ground(text=text).order_by().values("pk"))
    return found.defer(*_UNREAD).annotate(geometry_json=AsGeoJSON("geometry", precision=COORDINATE_DIGITS))


def issue_summary() -> DataIssueSummary:
    counts = {kind.value: dict.fromkeys(DataIssueState.values, 0) for kind in DataIssueKind}
    for kind, state, number in DataIssue.objects.order_by().values_list("kind", "state").annotate(Count("pk")):
        counts[kind][state] = number
    last = DataIssueSearch.objects.filter(pk=DataIssueSearch.SINGLE_ID).first()
    return DataIssueSummary(counts, last.searched_at if last else None, last.found if last else 0)
