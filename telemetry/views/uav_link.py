"""The HTTP link of companion computers. A UAV reads its own data only, and reports on itself only."""

import hashlib
from collections.abc import Sequence
from typing import Any

from django.utils import timezone
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.models import CommandState, UavCommand
from missions.selectors.given import Given, commands_by_key, given_to
from missions.services.commands.dispatch import ApprovedLoad, load_of
from missions.services.commands.flight_progress import FlightEnd
from telemetry.serializers.uav_link import (
    AcknowledgementsSerializer,
    GivenSerializer,
    LinkCapturesEnvelopeSerializer,
    LinkCapturesSerializer,
    NotedListSerializer,
    ReportsEnvelopeSerializer,
    ReportsSerializer,
    ResultsEnvelopeSerializer,
    ResultsSerializer,
    StoredCapturesSerializer,
    StoredReportsSerializer,
    StoredResultsSerializer,
    read_result,
)
from telemetry.services.links.companion_reports import USED_AGAIN, take_captures, take_reports
from telemetry.services.links.http_messages import note_received_over_http
from telemetry.services.links.uav_outbox import Acknowledgement, handed_to, note_acknowledgements
from telemetry.services.results import EndedFlight, take_results
from telemetry.views.uav_authentication import UavRate, UavsAlone, UavTokenAuthentication, uav_access
from workspace.api.parsers import MeasuredJSONParser, UavJSONParser
from workspace.api.renderers import FastJSONRenderer
from workspace.sessions.sign_in_attempts import address_of


def given_json(*, uav_id: int, upload: UavCommand | None, load: ApprovedLoad | None, waiting: Sequence[UavCommand]) -> dict[str, Any]:
    return {
        "uav": uav_id,
        "route": _route(upload, load) if upload and load else None,
        "commands": [
            {
                "id": command.pk,
                "sequence": command.sequence,
                "kind": command.kind,
                "priority": command.priority,
                "parameters": command.parameters,
                "expires_at": command.expires_at,
            }
            for command in waiting
        ],
    }


def _route(upload: UavCommand, load: ApprovedLoad) -> dict[str, Any]:
    assert upload.approval is not None  # noqa: S101 - a database constraint
    document = upload.approval.document
    content = load.content
    assert content is not None  # noqa: S101 - a UAV with a companion computer
    visited = {waypoint["target"] for waypoint in content["waypoints"]}
    return {
        "command": upload.pk,
        "mission": load.mission,
        "mission_name": document["mission"]["name"],
        "approval": load.approval,
        "flights": load.flights,
        "content": content,
        "content_sha256": load.content_sha256,
        "targets": [_target(target) for target in document["targets"] if target["sequence"] in visited],
    }


def _target(target: dict[str, Any]) -> dict[str, Any]:
    stretch = target["stretch"]
    return {
        "place": target["sequence"],
        "label": target["label"],
        "kind": target["kind"],
        "task": target["task"],
        "position": target["position"],
        "stretch": {"type": "LineString", "coordinates": stretch} if stretch else None,
        "geometry": target["geometry"],
    }


class UavView(APIView):
    """An endpoint for UAVs only. Each request counts as a contact of the UAV."""

    authentication_classes = [UavTokenAuthentication]
    parser_classes = [UavJSONParser]
    permission_classes = [UavsAlone]
    throttle_classes = [UavRate]
    throttle_scope = "uav-link"

    def initial(self, request: Request, *args: Any, **kwargs: Any) -> None:
        super().initial(request, *args, **kwargs)
        note_received_over_http(uav_id=uav_access(request).uav_id, address=address_of(request))


class UavTelemetry(UavView):
    parser_classes = [MeasuredJSONParser]

    @extend_schema(
        operation_id="report_telemetry",
        summary="Report where the UAV is and how it does",
        description=(
            "A batch is taken record by record: sound ones are stored, faulty ones are named by their index and are not to be sent again. "
            "A record that was stored before, under the same stream and sequence, is dropped: after a lost link all that was not answered "
            "is sent again. Records from the future or out of order are stored and flagged."
        ),
        request=ReportsSerializer,
        responses=StoredReportsSerializer,
    )
    def post(self, request: Request) -> Response:
        received_at = timezone.now()
        envelope = _envelope(ReportsEnvelopeSerializer, request)
        uav = uav_access(request)
        sent = envelope["records"]
        taken = take_reports(uav_id=uav.uav_id, place=uav.place, stream=envelope["stream"], sent=sent, received_at=received_at)
        return Response(
            {
                "stored": taken.counts.stored,
                "known": taken.counts.duplicates,
                "from_future": taken.counts.from_future,
                "late": taken.counts.late,
                "refused": [_refused(report.index, sent[report.index], report.faults) for report in taken.refused],
            }
        )


class UavCaptures(UavView):
    parser_classes = [MeasuredJSONParser]

    @extend_schema(
        operation_id="report_captures",
        summary="Report photos: where and when they were taken, and where the camera looked",
        description=(
            "Taken and numbered like telemetry, in streams of their own. A photo that the autopilot or camera reported by MAVLink within "
            "a second is the same one."
        ),
        request=LinkCapturesSerializer,
        responses=StoredCapturesSerializer,
    )
    def post(self, request: Request) -> Response:
        received_at = timezone.now()
        envelope = _envelope(LinkCapturesEnvelopeSerializer, request)
        uav, sent = uav_access(request), envelope["captures"]
        taken = take_captures(uav_id=uav.uav_id, place=uav.place, stream=envelope["stream"], sent=sent, received_at=received_at)
        return Response(
            {
                "stored": taken.counts.photos + taken.counts.joined,
                "known": taken.counts.known,
                "refused": [_refused(report.index, sent[report.index], report.faults) for report in taken.refused],
            }
        )


class UavResults(UavView):
    parser_classes = [MeasuredJSONParser]

    @extend_schema(
        operation_id="report_results",
        summary="Report what was found at targets, and how flights ended",
        description=(
            "Of routes that this UAV was sent alone. A result that was stored before, under the same stream and sequence, is dropped. The "
            "newest result of a target sets its state."
        ),
        request=ResultsSerializer,
        responses=StoredResultsSerializer,
    )
    def post(self, request: Request) -> Response:
        received_at = timezone.now()
        envelope = _envelope(ResultsEnvelopeSerializer, request)
        read, refused = [], {}
        for index, sent in enumerate(envelope["results"]):
            result, faults = read_result(sent)
            if result is None:
                refused[index] = faults
            else:
                read.append((index, result))
        taken = take_results(
            uav_id=uav_access(request).uav_id,
            stream=envelope["stream"],
            results=[result for _, result in read],
            flights=[
                EndedFlight(flight["approval"], flight["flight"], FlightEnd(flight["outcome"])) for flight in envelope.get("flights", [])
            ],
            received_at=received_at,
        )
        refused |= {read[place][0]: {"place": "It is no target that this UAV was sent to."} for place in taken.refused_results}
        refused |= {read[place][0]: {"sequence": USED_AGAIN} for place in taken.reused_results}
        reported = [_refused(index, envelope["results"][index], faults) for index, faults in sorted(refused.items())]
        return Response({"stored": taken.stored, "known": taken.known, "refused": reported, "refused_flights": taken.refused_flights})


class UavRoute(UavView):
    renderer_classes = [FastJSONRenderer]

    @extend_schema(
        operation_id="get_uav_route",
        summary="What the UAV is to fly, and the commands that wait for it",
        description=(
            "Asked every few seconds, with the ETag of the answer before in If-None-Match. The route is there from when it is sent until "
            "it is taken off or the mission is over. A command is handed over by this answer and is among `commands` until the UAV has "
            "told its end, or it has been overtaken, or is not wanted any more: each is to be carried out once."
        ),
        parameters=[OpenApiParameter("If-None-Match", str, OpenApiParameter.HEADER, description="the ETag as last seen")],
        responses={
            200: GivenSerializer,
            204: OpenApiResponse(description="Nothing to fly and nothing that waits."),
            304: OpenApiResponse(description="The same as last seen."),
        },
    )
    def get(self, request: Request) -> Response:
        uav_id = uav_access(request).uav_id
        given = given_to(uav_id)
        known = request.headers.get("If-None-Match", "").removeprefix("W/")  # a proxy that compresses responses makes the ETag weak
        if known == _etag(uav_id, given):
            return Response(status=304, headers={"ETag": _etag(uav_id, given), "Cache-Control": "private, no-cache"})
        given = handed_to(uav_id, given)
        headers = {"ETag": _etag(uav_id, given), "Cache-Control": "private, no-cache"}
        if given.upload is None and not given.waiting:
            return Response(status=204, headers=headers)
        commands = {command.pk: command for command in commands_by_key((*given.waiting, *filter(None, [given.upload])))}
        upload = commands.get(given.upload) if given.upload else None
        waiting = [commands[key] for key in given.waiting if key in commands]
        return Response(
            given_json(uav_id=uav_id, upload=upload, load=load_of(upload) if upload else None, waiting=waiting), headers=headers
        )


class UavAcknowledgements(UavView):
    @extend_schema(
        operation_id="acknowledge_commands",
        summary="Say what became of commands",
        description=(
            "`acknowledged`: it is here. `applied`: it is done. `failed`: it is not, and `reason` says why. An upload is applied only with "
            "the `content_sha256` of what the UAV holds, and only if this is what was approved: otherwise the command fails. Asked again, "
            "nothing changes twice."
        ),
        request=AcknowledgementsSerializer,
        responses=NotedListSerializer,
    )
    def post(self, request: Request) -> Response:
        reported = _envelope(AcknowledgementsSerializer, request)["acknowledgements"]
        acknowledgements = [
            Acknowledgement(entry["command"], CommandState(entry["state"]), entry.get("reason", ""), entry.get("content_sha256"))
            for entry in reported
        ]
        noted = note_acknowledgements(uav_id=uav_access(request).uav_id, acknowledgements=acknowledgements)
        return Response(
            {"results": [{"command": one.command_id, "noted": one.noted, "state": one.state, "words": one.words} for one in noted]}
        )


def _etag(uav_id: int, given: Given) -> str:
    """Return the ETag of upload and commands, which never change."""
    digest = hashlib.sha256(f"{uav_id} {given.upload} {' '.join(map(str, given.waiting))}".encode()).hexdigest()
    return f'"{digest[:32]}"'


def _envelope(serializer_class: Any, request: Request) -> dict[str, Any]:
    serializer = serializer_class(data=request.data)
    serializer.is_valid(raise_exception=True)
    return dict(serializer.validated_data)


def _refused(index: int, sent: Any, faults: dict[str, str]) -> dict[str, Any]:
    sequence = sent.get("sequence") if isinstance(sent, dict) else None
    is_number = isinstance(sequence, int) and not isinstance(sequence, bool)
    return {"index": index, "sequence": sequence if is_number else None, "faults": faults}
