"""Alerts: list, detail, acknowledgement, notes and closing."""

from uuid import UUID

from django.shortcuts import get_object_or_404
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.views.parameters import invalid
from telemetry.models import Alert, AlertLevel
from telemetry.selectors.alerts import AlertFilter, alerts_of_organisation, alerts_that_match, unanswered_counts
from telemetry.serializers import alerts as shapes
from telemetry.services.alerts.alerts import LevelRose, acknowledge_alert, acknowledge_ended, note_alert
from telemetry.services.alerts.down_alerts import ClosedByItself, close_down_alert
from telemetry.views.log_filters import UAV, mission_of, time_of
from workspace.api.errors import ApiProblem
from workspace.api.idempotency import idempotent
from workspace.api.paging import asked_choice, asked_flag, page_of
from workspace.api.permissions import FLYING
from workspace.api.schema import PAGE_PARAMETERS, TIME, several_of
from workspace.api.signed_in import SignedInRequest

STATES = ("open", "closed")
NEWEST_FIRST = ("-opened_at", "-pk")
MAX_NOTES = 200
FILTERS = [
    OpenApiParameter("state", str, enum=STATES, description="open or closed ones; both without it"),
    OpenApiParameter("acknowledged", bool),
    OpenApiParameter("level", several_of(AlertLevel.values), description=f"one or several with commas: {', '.join(AlertLevel.values)}"),
    OpenApiParameter("code", str, description="one or several with commas"),
    UAV.documented,
    OpenApiParameter("mission", UUID, description="id of a mission"),
    OpenApiParameter("opened_from", TIME, description="opened at or after this time, with its zone"),
    OpenApiParameter("opened_before", TIME, description="opened before this time, with its zone"),
]


class Alerts(APIView):
    @extend_schema(
        operation_id="list_alerts", summary="Alerts, the newest first", parameters=[*FILTERS, *PAGE_PARAMETERS],
        responses=shapes.AlertPageSerializer,
    )  # fmt: skip
    def get(self, request: SignedInRequest) -> Response:
        page = page_of(request, alerts_that_match(request.user.organisation, _asked(request)), order=NEWEST_FIRST)
        return Response({"results": [shapes.alert_json(row, note_count=row.note_count) for row in page.rows], "next": page.next})


class AlertCounts(APIView):
    @extend_schema(
        operation_id="count_alerts",
        summary="How many alerts nobody has acknowledged, by level",
        responses=shapes.UnansweredAlertsSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        return Response(unanswered_counts(request.user.organisation))


class AlertDetail(APIView):
    @extend_schema(operation_id="get_alert", summary="An alert, its notes and its course", responses=shapes.AlertDetailSerializer)
    def get(self, request: SignedInRequest, alert_id: int) -> Response:
        return Response(_detail(_alert(request, alert_id)))


class AlertAcknowledgement(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="acknowledge_alert",
        summary="Say that somebody knows: it goes on, and is silent",
        description="Acknowledged again it stays with who was first. Raised to a higher level it has to be acknowledged anew.",
        request=shapes.AcknowledgementInputSerializer,
        responses={200: shapes.AlertDetailSerializer, 409: OpenApiResponse(description="It has risen above `seen_level`: `level_rose`.")},
    )
    @idempotent
    def post(self, request: SignedInRequest, alert_id: int) -> Response:
        alert = _alert(request, alert_id)
        body = shapes.AcknowledgementInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        try:
            acknowledge_alert(alert=alert, actor=request.user, **body.validated_data)
        except LevelRose as error:
            raise ApiProblem(409, "level_rose", _rose_words(error.alert.level)) from error
        return Response(_detail(_alert(request, alert_id)))


class EndedAlertsAcknowledgement(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="acknowledge_ended_alerts",
        summary="Acknowledge several critical alerts that have ended",
        description="Answered alert by alert. One that is still open is left as it is, to be acknowledged singly.",
        request=shapes.EndedAlertsInputSerializer,
        responses=shapes.EndedAlertsSerializer,
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        body = shapes.EndedAlertsInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        outcomes = acknowledge_ended(
            organisation=request.user.organisation, alert_ids=set(body.validated_data["alerts"]), actor=request.user
        )
        return Response({"results": [{"id": alert_id, "outcome": outcome} for alert_id, outcome in outcomes.items()]})


class AlertNotes(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="note_alert", summary="Write a note to an alert; it is never changed", request=shapes.AlertNoteInputSerializer,
        responses={201: shapes.AlertNoteSerializer},
    )  # fmt: skip
    @idempotent
    def post(self, request: SignedInRequest, alert_id: int) -> Response:
        alert = _alert(request, alert_id)
        body = shapes.AlertNoteInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        if alert.notes.count() >= MAX_NOTES:
            raise invalid("text", f"An alert takes {MAX_NOTES} notes.")
        note = note_alert(alert=alert, actor=request.user, text=body.validated_data["text"])
        return Response(shapes.note_json(note), status=201)


class AlertClosing(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="close_alert",
        summary="Close the alert of a UAV that is down where its flight does not end, with what became of it",
        description="Other alerts are over when their cause is gone: they are answered by 409.",
        request=shapes.ClosingInputSerializer,
        responses={200: shapes.AlertDetailSerializer, 409: OpenApiResponse(description="Nobody closes this alert.")},
    )
    @idempotent
    def post(self, request: SignedInRequest, alert_id: int) -> Response:
        alert = _alert(request, alert_id)
        body = shapes.ClosingInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        try:
            close_down_alert(alert=alert, actor=request.user, reason=body.validated_data["reason"])
        except ClosedByItself as error:
            raise ApiProblem(409, "closed_by_itself", _("This alert is over when its cause is gone.")) from error
        return Response(_detail(_alert(request, alert_id)))


def _rose_words(level: str) -> str:
    if level == AlertLevel.CRITICAL:
        return _("Not acknowledged: this alert has become critical. Read it again, then acknowledge it.")
    return _("Not acknowledged: this alert has become a warning. Read it again, then acknowledge it.")


def _alert(request: SignedInRequest, alert_id: int) -> Alert:
    return get_object_or_404(alerts_of_organisation(request.user.organisation), pk=alert_id)


def _detail(alert: Alert) -> dict[str, object]:
    notes = [shapes.note_json(note) for note in alert.notes.select_related("author")]
    return {**shapes.alert_json(alert, note_count=len(notes)), "written": notes, "course": alert.course}


def _asked(request: Request) -> AlertFilter:
    """Return the requested filter. Raises ApiProblem 400."""
    ask = request.query_params
    state = asked_choice(request, "state", STATES)
    levels = tuple(filter(None, ask.get("level", "").split(",")))
    if any(level not in AlertLevel.values for level in levels):
        raise invalid("level", f"{', '.join(AlertLevel.values)}.")
    return AlertFilter(
        is_open=state == "open" if state else None,
        is_acknowledged=asked_flag(request, "acknowledged"),
        levels=levels,
        codes=tuple(code[:50].replace("\0", "") for code in ask.get("code", "").split(",") if code),
        uav_id=UAV.asked(request),
        mission_id=mission_of(request),
        opened_from=time_of(request, "opened_from"),
        opened_before=time_of(request, "opened_before"),
    )
