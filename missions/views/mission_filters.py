"""What the list of missions may be asked for, from the address to a filter."""

from typing import Any

from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter
from rest_framework.request import Request

from missions.list_selectors import LAST_CHANGED_FIRST, ORDERS, MissionFilter, order_of
from missions.models import MissionState
from workspace.errors import ApiProblem
from workspace.external_data import EXTERNAL_ID, asked_external_id
from workspace.paging import asked_flag, asked_instant
from workspace.schema import DAY_OR_TIME, several_of
from workspace.whole_numbers import WholeNumber

ORDER_NAMES = [*ORDERS, *(f"-{name}" for name in ORDERS)]
UAV = WholeNumber("uav", "id of a UAV that the mission uses")
FILTER_PARAMETERS = [
    OpenApiParameter("text", str, description="part of the name, of the author's name or of a target's name"),
    OpenApiParameter("state", several_of(MissionState.values), description=f"one or several with commas: {', '.join(MissionState.values)}"),
    OpenApiParameter("author", str, description="user name"),
    UAV.documented,
    OpenApiParameter("stale", bool, description="whether the ground or a UAV has changed since the mission was planned"),
    OpenApiParameter("changed_from", DAY_OR_TIME, description="date or time with offset, ISO 8601"),
    OpenApiParameter("changed_before", DAY_OR_TIME, description="date or time with offset, ISO 8601"),
    EXTERNAL_ID,
    OpenApiParameter("target_external_id", str, description="the external id of one of its targets"),
    OpenApiParameter("deleted", bool, description="true: the deleted ones"),
    OpenApiParameter("order", str, enum=ORDER_NAMES, description="the column to sort by, with - for descending; -changed without one"),
]


def asked_filter(request: Request) -> MissionFilter:
    """Raises ApiProblem 400 for what no list can be asked for."""
    ask = request.query_params
    states = tuple(state for state in ask.get("state", "").split(",") if state)
    if unknown := [state for state in states if state not in MissionState.values]:
        raise _refusal("state", _("There is no state %(state)s.") % {"state": unknown[0][:20]})
    return MissionFilter(
        text=ask.get("text", "").strip()[:100].replace("\0", ""),
        states=states,
        author=ask.get("author", "").strip()[:150].replace("\0", ""),
        uav=UAV.asked(request),
        is_stale=asked_flag(request, "stale"),
        changed_from=asked_instant(request, "changed_from"),
        changed_before=asked_instant(request, "changed_before"),
        external_id=asked_external_id(request),
        target_external_id=asked_external_id(request, "target_external_id"),
        is_deleted=asked_flag(request, "deleted") or False,
    )


def asked_order(request: Request) -> tuple[str, str]:
    try:
        return order_of(request.query_params.get("order") or LAST_CHANGED_FIRST)
    except KeyError as error:
        raise _refusal("order", _("Missions are sorted by %(names)s.") % {"names": ", ".join(ORDERS)}) from error


def _refusal(name: str, message: str) -> Any:
    return ApiProblem(400, "invalid", f"{name}: {message}", details={name: [message]})
