"""Links of UAVs, status texts of their autopilots, and flight logs as files."""

from dataclasses import asdict
from typing import Any
from urllib.parse import urlsplit

from django.http import FileResponse, Http404
from django.shortcuts import get_object_or_404
from django.urls import reverse
from django.utils import timezone
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from accounts.invitations import public_address
from missions.views.uavs import uav_or_404
from telemetry.models import FlightLog
from telemetry.selectors.vehicles import LogFileMissing, connection_of, file_of, flight_logs_of, gateway_addresses, texts_of
from telemetry.serializers.log import FlightLogPageSerializer, VehicleTextPageSerializer, VehicleTextSerializer
from telemetry.serializers.vehicles import UavConnectionSerializer, connection_json
from workspace.api.paging import page_of
from workspace.api.renderers import OneAnswer
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest

TLOG_TYPE = "application/octet-stream"


class UavConnection(APIView):
    @extend_schema(
        operation_id="get_uav_connection",
        summary="When a UAV was heard last and by which door, its mode, and the mission that is on it",
        responses=UavConnectionSerializer,
    )
    def get(self, request: SignedInRequest, uav_id: int) -> Response:
        uav = uav_or_404(request.user, uav_id)
        server = public_address(request)
        site_host = urlsplit(server).hostname or ""
        facts = {"server": server, "gateway": [asdict(address) for address in gateway_addresses(site_host)]}
        return Response(connection_json(uav, connection_of(uav), timezone.now()) | facts)


class VehicleTexts(APIView):
    @extend_schema(
        operation_id="list_vehicle_texts",
        summary="What a UAV's autopilot said in words, the newest first",
        parameters=PAGE_PARAMETERS,
        responses=VehicleTextPageSerializer,
    )
    def get(self, request: SignedInRequest, uav_id: int) -> Response:
        page = page_of(request, texts_of(uav_or_404(request.user, uav_id)), order=("-received_at", "-pk"))
        return Response({"results": VehicleTextSerializer(page.rows, many=True).data, "next": page.next})


class FlightLogs(APIView):
    @extend_schema(
        operation_id="list_flight_logs",
        summary="Logs of a UAV's flights, the newest first",
        parameters=PAGE_PARAMETERS,
        responses=FlightLogPageSerializer,
    )
    def get(self, request: SignedInRequest, uav_id: int) -> Response:
        page = page_of(request, flight_logs_of(uav_or_404(request.user, uav_id)), order=("-started_at", "-pk"))
        return Response({"results": [_log_json(log) for log in page.rows], "next": page.next})


class FlightLogFile(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "exports"

    @extend_schema(
        operation_id="download_flight_log",
        summary="The log of a flight, every MAVLink frame in both directions, as a tlog file",
        responses={(200, TLOG_TYPE): OpenApiTypes.BINARY},
    )
    def get(self, request: SignedInRequest, uav_id: int, log_id: int) -> FileResponse:
        uav = uav_or_404(request.user, uav_id)
        log = get_object_or_404(flight_logs_of(uav), pk=log_id)
        try:
            path = file_of(log)
        except LogFileMissing as error:
            raise Http404 from error
        name = f"{log.started_at:%Y%m%d-%H%M%S}-uav{uav.pk}.tlog"
        return FileResponse(path.open("rb"), as_attachment=True, filename=name, content_type=TLOG_TYPE)


def _log_json(log: FlightLog) -> dict[str, Any]:
    return {
        "id": log.pk,
        "mission": log.mission_id,
        "started_at": log.started_at,
        "ended_at": log.ended_at,
        "size_bytes": log.size_bytes,
        "file": reverse("api-flight-log-file", args=[log.uav_id, log.pk]),
    }
