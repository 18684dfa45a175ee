"""Alert limits of a UAV type or a mission."""

from dataclasses import asdict
from typing import Any
from uuid import UUID

from django.db import transaction
from django.shortcuts import get_object_or_404
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.views.parameters import invalid
from missions.models import Mission, UavType
from missions.selectors.fleet import types_of_organisation
from telemetry.alerting.limits import BOUNDS, AlertLimits, InvalidLimits, checked_limits, limits_of
from telemetry.serializers.alerts import AlertLimitsSerializer
from workspace.api.signed_in import SignedInRequest
from workspace.audit import record_change
from workspace.models import User

DESCRIPTION = "All that is stated, by name, in one object; what is left out or null is as usual. See docs/alerts.md."


def state_alert_limits(*, row: UavType | Mission, limits: Any, actor: User) -> None:
    """Store all limits that differ from the defaults, and nothing else of the row. Raises InvalidLimits."""
    stated = checked_limits(limits)
    limits_of(stated)
    with transaction.atomic():
        rows = Mission.objects.filter(pk=row.pk) if isinstance(row, Mission) else UavType.objects.filter(pk=row.pk)
        held = rows.select_for_update(no_key=True).get()
        before, held.alert_limits = held.alert_limits, stated
        if before != stated:
            rows.update(alert_limits=stated)
            record_change(
                organisation=row.organisation, actor=actor, action="state-alert-limits",
                subject_type="mission" if isinstance(row, Mission) else "uav_type", subject_id=row.pk, before=before, after=stated,
            )  # fmt: skip
    row.alert_limits = stated


class UavTypeAlertLimits(APIView):
    @extend_schema(
        operation_id="get_alert_limits_of_uav_type", summary="Where alerts of a type's UAVs begin", responses=AlertLimitsSerializer
    )
    def get(self, request: SignedInRequest, type_id: int) -> Response:
        return _answer(_type(request.user, type_id))

    @extend_schema(
        operation_id="state_alert_limits_of_uav_type", summary="Say where alerts of a type's UAVs begin", description=DESCRIPTION,
        request=OpenApiTypes.OBJECT, responses=AlertLimitsSerializer,
    )  # fmt: skip
    def put(self, request: SignedInRequest, type_id: int) -> Response:
        return _state(_type(request.user, type_id), request)


class MissionAlertLimits(APIView):
    @extend_schema(
        operation_id="get_alert_limits_of_mission", summary="Where alerts of a mission begin", responses=AlertLimitsSerializer
    )  # fmt: skip
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        return _answer(_mission(request.user, mission_id))

    @extend_schema(
        operation_id="state_alert_limits_of_mission", summary="Say where alerts of a mission begin, also while it flies",
        description=DESCRIPTION, request=OpenApiTypes.OBJECT, responses=AlertLimitsSerializer,
    )  # fmt: skip
    def put(self, request: SignedInRequest, mission_id: UUID) -> Response:
        return _state(_mission(request.user, mission_id), request)


def _type(user: User, type_id: int) -> UavType:
    return get_object_or_404(types_of_organisation(user.organisation), pk=type_id)


def _mission(user: User, mission_id: UUID) -> Mission:
    return get_object_or_404(Mission, organisation=user.organisation, pk=mission_id, deleted_at=None)


def _state(row: UavType | Mission, request: SignedInRequest) -> Response:
    try:
        state_alert_limits(row=row, limits=request.data, actor=request.user)
    except InvalidLimits as error:
        raise invalid(error.place, f"{error.place} {error.message}.") from error
    return _answer(row)


def _answer(row: UavType | Mission) -> Response:
    body: dict[str, Any] = {"stated": row.alert_limits, "in_force": asdict(limits_of(row.alert_limits)), "usual": asdict(AlertLimits())}
    return Response(body | {"bounds": {name: list(bounds) for name, bounds in BOUNDS.items()}})
