"""The HTTP link: what a companion computer asks for and tells. A UAV gets its own data only, and tells of itself only."""

from typing import Any

from django.utils import timezone
from drf_spectacular.utils import extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from telemetry.serializers.uav_link import (
    MOST_RESULT_BYTES,
    ReportsEnvelopeSerializer,
    ReportsSerializer,
    ResultsEnvelopeSerializer,
    ResultsSerializer,
    StoredReportsSerializer,
    StoredResultsSerializer,
    read_result,
)
from telemetry.services.companion_reports import take_reports
from telemetry.services.heard import note_heard_over_http
from telemetry.services.results import take_results
from telemetry.views.uav_authentication import UavAccess, UavRate, UavsAlone, UavTokenAuthentication
from workspace.parsers import MeasuredJSONParser
from workspace.sign_in_attempts import address_of


class UavView(APIView):
    """An address for UAVs alone. Whatever a UAV asks here, it has been heard."""

    authentication_classes = [UavTokenAuthentication]
    permission_classes = [UavsAlone]
    throttle_classes = [UavRate]
    throttle_scope = "uav-link"

    def initial(self, request: Request, *args: Any, **kwargs: Any) -> None:
        super().initial(request, *args, **kwargs)
        note_heard_over_http(uav_id=request.auth.uav_id, address=address_of(request))


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
        uav: UavAccess = request.auth
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


class UavResults(UavView):
    parser_classes = [MeasuredJSONParser]

    @extend_schema(
        operation_id="report_results",
        summary="Report what was found at targets",
        description=(
            "Of targets on the UAV's own routes alone. A result that was stored before, under the same stream and sequence, is dropped. "
            f"The newest result of a target sets its state. `values` of one result have at most {MOST_RESULT_BYTES // 1024} kB."
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
        uav: UavAccess = request.auth
        results = [result for _, result in read]
        taken = take_results(uav_id=uav.uav_id, stream=envelope["stream"], results=results, received_at=received_at)
        refused |= {read[place][0]: {"target": "It is no target that this UAV was given."} for place in taken.refused}
        told = [_refused(index, envelope["results"][index], faults) for index, faults in sorted(refused.items())]
        return Response({"stored": taken.stored, "known": taken.known, "refused": told})


def _envelope(serializer_class: Any, request: Request) -> dict[str, Any]:
    serializer = serializer_class(data=request.data)
    serializer.is_valid(raise_exception=True)
    return dict(serializer.validated_data)


def _refused(index: int, sent: Any, faults: dict[str, str]) -> dict[str, Any]:
    sequence = sent.get("sequence") if isinstance(sent, dict) else None
    is_number = isinstance(sequence, int) and not isinstance(sequence, bool)
    return {"index": index, "sequence": sequence if is_number else None, "faults": faults}
