"""The log: records by place, time, mission and UAV, and the query parameters for them."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any
from uuid import UUID

from django.db.models import F, FloatField, Max, Min, QuerySet, Value, Window
from django.db.models.functions import Extract, Floor, RowNumber
from django.http import Http404
from django.utils import timezone
from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.views.parameters import BOX, box_of, invalid
from mavlink.decoding.companion_reports import instant
from missions.views.uavs import uav_or_404
from telemetry.exports.geojson_file import record_feature
from telemetry.selectors.log import LogFilter, as_logged, in_time, latest_record, records_that_match
from telemetry.serializers.log import RecordCollectionSerializer, RecordFeatureSerializer
from workspace.api.paging import page_of
from workspace.api.renderers import FastJSONRenderer
from workspace.api.schema import PAGE_PARAMETERS, TIME
from workspace.api.signed_in import SignedInRequest
from workspace.api.whole_numbers import WholeNumber

MIN_DURATION_S, MAX_DURATION_S = 1e-3, 366 * 86_400.0  # between chosen rows
USUAL_SPAN = timedelta(days=1)
UAV = WholeNumber("uav", "id of a UAV")
MAX_RECORDS = WholeNumber(
    "most", "so many at most over all pages, evenly chosen, but up to two a UAV; `next` has the every_s", maximum=100_000
)
TIMES = [
    OpenApiParameter("from", TIME, description="measured at or after this time, with its zone"),
    OpenApiParameter("to", TIME, description="measured before this time, with its zone"),
]
THINNED = [
    OpenApiParameter(
        "every_s",
        {"type": "number", "minimum": MIN_DURATION_S, "maximum": MAX_DURATION_S},
        description="of each UAV the first record in so many seconds, and none from the future",
    ),
    MAX_RECORDS.documented,
]
FILTERS = [
    *TIMES,
    UAV.documented,
    OpenApiParameter("mission", UUID, description="id of a mission"),
    BOX,
    *THINNED,
]


def one_each(rows: QuerySet[Any], every_s: float, *, time: str = "measured_at") -> QuerySet[Any]:
    """Return the first row of each UAV in each interval of so many seconds."""
    stretch = Floor(Extract(time, "epoch") / Value(every_s), output_field=FloatField())
    place = Window(RowNumber(), partition_by=[F("uav_id"), stretch], order_by=[F(time), F("pk")])
    return rows.model._default_manager.filter(pk__in=rows.order_by().annotate(place=place).filter(place=1).values("pk"))


def spacing_for(rows: QuerySet[Any], most: int, *, time: str = "measured_at") -> float | None:
    """Return the interval [s] that leaves at most `most` rows, but up to two per UAV; None if there are no more than that."""
    unordered = rows.order_by()
    if len(unordered.values_list("pk")[: most + 1]) <= most:
        return None
    facts = unordered.aggregate(first=Min(time), last=Max(time))
    uavs = unordered.values("uav_id").distinct().count()
    span: timedelta = facts["last"] - facts["first"]
    stretches = max(most // uavs - 1, 1)  # whole intervals; the span may touch one more
    return min(max(span.total_seconds() / stretches, MIN_DURATION_S), MAX_DURATION_S)


@dataclass(frozen=True)
class Sampled:
    """Thinned rows with the interval between those of a UAV; None if all rows are included."""

    rows: QuerySet[Any]
    every_s: float | None
    most: int | None

    def next(self, address: str | None) -> str | None:
        """Return the address of the next page, with the interval of the first page, as new rows may have been stored since."""
        if address is None or self.most is None or self.every_s is None:
            return address
        return address.replace(f"most={self.most}", f"every_s={self.every_s!r}")


def asked_log(request: Request) -> LogFilter:
    """Return the requested filter; the last day without a UAV, a mission or a start. Raises ApiProblem 400."""
    uav_id, mission_id = UAV.asked(request), mission_of(request)
    wanted = LogFilter(uav_id, mission_id, time_of(request, "from"), time_of(request, "to"), box_of(request))
    if uav_id is None and mission_id is None and wanted.measured_from is None:
        last_day = (wanted.measured_before or timezone.now()) - USUAL_SPAN
        wanted = LogFilter(None, None, last_day, wanted.measured_before, wanted.box)
    return wanted


def sampled(
    request: Request, rows: QuerySet[Any], *, of: Callable[[QuerySet[Any]], QuerySet[Any]] = lambda rows: rows, time: str = "measured_at"
) -> Sampled:
    """Return all rows without thinning, else those chosen from `of` them. Raises ApiProblem 400."""
    every_s, most = request.query_params.get("every_s", ""), MAX_RECORDS.asked(request)
    if every_s and most:
        raise invalid("most", "Either every_s or most.")
    if not every_s and not most:
        return Sampled(rows, None, None)
    candidates = of(rows)
    spacing_s = spacing_for(candidates, most, time=time) if most else _seconds(every_s)
    chosen = rows if spacing_s is None else one_each(candidates, spacing_s, time=time)
    return Sampled(chosen, spacing_s, most)


def time_of(request: Request, name: str) -> datetime | None:
    text = request.query_params.get(name, "")
    try:
        return instant(text) if text else None
    except ValueError as error:
        raise invalid(name, str(error)) from error


def _seconds(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not MIN_DURATION_S <= value <= MAX_DURATION_S:
        raise invalid("every_s", f"A number of seconds from {MIN_DURATION_S:g} to {MAX_DURATION_S:g} is needed.")
    return value


def mission_of(request: Request) -> UUID | None:
    text = request.query_params.get("mission", "")
    try:
        return UUID(text) if text else None
    except ValueError as error:
        raise invalid("mission", "The id of a mission is needed.") from error


class TelemetryLog(APIView):
    renderer_classes = [FastJSONRenderer]

    @extend_schema(
        operation_id="list_telemetry",
        summary="What UAVs reported, in the order of measurement",
        description=(
            "GeoJSON. Without a UAV, a mission or a beginning: of the last day. Records from the future and out of order are among them, "
            "flagged. Thinning out is done in the database: `every_s` keeps the first record of each UAV in each so many seconds, `most` "
            "chooses the seconds."
        ),
        parameters=[*FILTERS, *PAGE_PARAMETERS],
        responses=RecordCollectionSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        records = records_that_match(request.user.organisation, asked_log(request))
        chosen = sampled(request, records, of=in_time)
        page = page_of(request, chosen.rows.select_related("uav", "stream"), order=("measured_at", "pk"))
        return Response(
            {
                "type": "FeatureCollection",
                "features": [record_feature(as_logged(record)) for record in page.rows],
                "every_s": chosen.every_s,
                "next": chosen.next(page.next),
            }
        )


class LatestTelemetry(APIView):
    @extend_schema(
        operation_id="get_latest_telemetry",
        summary="What a UAV measured last; never a record from the future",
        responses=RecordFeatureSerializer,
    )
    def get(self, request: SignedInRequest, uav_id: int) -> Response:
        record = latest_record(uav_or_404(request.user, uav_id))
        if record is None:
            raise Http404
        return Response(record_feature(as_logged(record)))
