"""Rows by time, thinned out in the database."""

from datetime import timedelta
from typing import Any

from django.db.models import F, FloatField, Max, Min, QuerySet, Value, Window
from django.db.models.functions import Extract, Floor, RowNumber

SHORTEST_S, LONGEST_S = 1e-3, 366 * 86_400.0  # between chosen rows


def one_each(rows: QuerySet[Any], every_s: float, *, time: str = "measured_at") -> QuerySet[Any]:
    """The first of each UAV in each stretch of so many seconds."""
    stretch = Floor(Extract(time, "epoch") / Value(every_s), output_field=FloatField())
    place = Window(RowNumber(), partition_by=[F("uav_id"), stretch], order_by=[F(time), F("pk")])
    return rows.model._default_manager.filter(pk__in=rows.order_by().annotate(place=place).filter(place=1).values("pk"))


def spacing_for(rows: QuerySet[Any], most: int, *, time: str = "measured_at") -> float | None:
    """How many seconds apart at most so many of them lie, but up to two a UAV; None where they are no more than that."""
    unordered = rows.order_by()
    if len(unordered.values_list("pk")[: most + 1]) <= most:
        return None
    facts = unordered.aggregate(first=Min(time), last=Max(time))
    uavs = unordered.values("uav_id").distinct().count()
    span: timedelta = facts["last"] - facts["first"]
    stretches = max(most // uavs - 1, 1)  # whole ones; the span may touch one more than it has
    return min(max(span.total_seconds() / stretches, SHORTEST_S), LONGEST_S)
