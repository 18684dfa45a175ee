"""What the log may be asked for, from the address to a filter."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any
from uuid import UUID

from django.db.models import QuerySet
from django.utils import timezone
from drf_spectacular.utils import OpenApiParameter
from rest_framework.request import Request

from inspection.views.parameters import BOX, box_of, invalid
from mavlink.decoding.companion_reports import instant
from telemetry.selectors.log import LogFilter
from telemetry.selectors.thinning import LONGEST_S, SHORTEST_S, one_each, spacing_for
from workspace.schema import TIME
from workspace.whole_numbers import WholeNumber

USUAL_SPAN = timedelta(days=1)
UAV = WholeNumber("uav", "id of a UAV")
MOST = WholeNumber("most", "so many at most over all pages, evenly chosen, but up to two a UAV; `next` has the every_s", maximum=100_000)
TIMES = [
    OpenApiParameter("from", TIME, description="measured at or after this time, with its zone"),
    OpenApiParameter("to", TIME, description="measured before this time, with its zone"),
]
THINNED = [
    OpenApiParameter(
        "every_s",
        {"type": "number", "minimum": SHORTEST_S, "maximum": LONGEST_S},
        description="of each UAV the first record in so many seconds, and none from the future",
    ),
    MOST.documented,
]
FILTERS = [
    *TIMES,
    UAV.documented,
    OpenApiParameter("mission", UUID, description="id of a mission"),
    BOX,
    *THINNED,
]


@dataclass(frozen=True)
class Sampled:
    """Rows as they were thinned out: how far apart those of a UAV were chosen, None where all of them are there."""

    rows: QuerySet[Any]
    every_s: float | None
    most: int | None

    def next(self, address: str | None) -> str | None:
        """Later pages keep the spacing that the first one chose, though more rows may have come."""
        if address is None or self.most is None or self.every_s is None:
            return address
        return address.replace(f"most={self.most}", f"every_s={self.every_s!r}")


def asked_log(request: Request) -> LogFilter:
    """Without a UAV, a mission or a beginning: of the last day. Raises ApiProblem 400."""
    uav_id, mission_id = UAV.asked(request), mission_of(request)
    wanted = LogFilter(uav_id, mission_id, time_of(request, "from"), time_of(request, "to"), box_of(request))
    if uav_id is None and mission_id is None and wanted.measured_from is None:
        last_day = (wanted.measured_before or timezone.now()) - USUAL_SPAN
        wanted = LogFilter(None, None, last_day, wanted.measured_before, wanted.box)
    return wanted


def sampled(
    request: Request, rows: QuerySet[Any], *, of: Callable[[QuerySet[Any]], QuerySet[Any]] = lambda rows: rows, time: str = "measured_at"
) -> Sampled:
    """All rows where no thinning is asked for, else those chosen from `of` them. Raises ApiProblem 400."""
    every_s, most = request.query_params.get("every_s", ""), MOST.asked(request)
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
    if not SHORTEST_S <= value <= LONGEST_S:
        raise invalid("every_s", f"A number of seconds from {SHORTEST_S:g} to {LONGEST_S:g} is needed.")
    return value


def mission_of(request: Request) -> UUID | None:
    text = request.query_params.get("mission", "")
    try:
        return UUID(text) if text else None
    except ValueError as error:
        raise invalid("mission", "The id of a mission is needed.") from error
