"""What photos prove of a mission's targets: promised, rehearsed, achieved."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any
from uuid import UUID

from django.http import Http404, StreamingHttpResponse
from django.utils.text import slugify
from django.utils.translation import gettext as _
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.exporters.text_pieces import Value, cell, csv_pieces
from inspection.views.parameters import invalid
from missions.models import InspectionTarget, Mission
from missions.serializers.view_plans import MissionCoverageSerializer
from missions.services.photo_coverage import coverage_of_targets, photographed_targets
from missions.views.missions import mission_or_404
from workspace.api.errors import ApiProblem
from workspace.api.paging import page_of
from workspace.api.renderers import FastJSONRenderer, OneAnswer
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest

TARGETS_A_PAGE, MAX_TARGETS_A_PAGE = 4, 10  # each takes up to some seconds when it is asked for the first time
REHEARSAL = OpenApiParameter("rehearsal", UUID, description="whose photos count as rehearsed; the newest that is done without it")
COLUMNS = (
    "target", "label", "asset_id", "camera", "asked_gsd_mm", "proof", "conditions", "photos", "photos_not_counted", "component", "number",
    "area_m2", "shown", "reachable", "gsd_mm", "angle_deg", "limit",
)  # fmt: skip


class MissionCoverage(APIView):
    renderer_classes = [FastJSONRenderer]
    throttle_scope = "coverage"

    @extend_schema(
        operation_id="list_mission_coverage",
        summary="What photos of a mission show of its towers: promised, rehearsed, achieved",
        description="Of each target with `views`, by component: what the planned photos show, those of a rehearsal with the true poses of "
        "lenses in each of its conditions, and those that UAVs reported. Photos of which height, position or attitude is unknown are "
        f"listed in `not_counted`. {TARGETS_A_PAGE} targets a page by default, {MAX_TARGETS_A_PAGE} at most.",
        parameters=[REHEARSAL, *PAGE_PARAMETERS],
        responses=MissionCoverageSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        page = page_of(
            request, photographed_targets(mission), order=("sequence",), default_limit=TARGETS_A_PAGE, max_limit=MAX_TARGETS_A_PAGE
        )
        return Response({"results": list(_coverage(request, mission, page.rows)), "next": page.next})


class MissionCoverageFile(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "exports"

    @extend_schema(
        operation_id="export_mission_coverage",
        summary="What photos of a mission show of its towers, by component, as CSV",
        description="`proof`: promised, rehearsed, achieved. Shares are of the component's area, 0 to 1.",
        parameters=[REHEARSAL],
        responses={
            (200, "text/csv"): OpenApiTypes.STR,
            409: OpenApiResponse(description="The mission photographs no target: there is no file."),
        },
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> StreamingHttpResponse:
        mission = mission_or_404(request.user, mission_id)
        targets = list(photographed_targets(mission).order_by("sequence"))
        if not targets:
            raise ApiProblem(409, "no_photos", _("No target of this mission has planned photos."))
        pieces = csv_pieces(COLUMNS, _rows(_coverage(request, mission, targets)))
        response = StreamingHttpResponse(pieces, content_type="text/csv; charset=utf-8")
        response["Content-Disposition"] = f'attachment; filename="{slugify(mission.name) or "mission"}-coverage.csv"'
        response["Cache-Control"] = "private, no-cache"
        return response


def _coverage(request: Request, mission: Mission, targets: Sequence[InspectionTarget]) -> Iterator[dict[str, Any]]:
    """Raises ApiProblem 400, and Http404 where the mission has no such rehearsal."""
    text = request.query_params.get("rehearsal", "")
    try:
        rehearsal = UUID(text) if text else None
    except ValueError as error:
        raise invalid("rehearsal", _("This is no key of a rehearsal.")) from error
    try:
        return coverage_of_targets(mission, targets, rehearsal)
    except LookupError as error:
        raise Http404 from error


def _rows(targets: Iterable[dict[str, Any]]) -> Iterator[Iterator[Value]]:
    for target in targets:
        head = [target["target"], target["label"], target["asset"], target["camera"], target["gsd_mm"]]
        proofs = [("promised", "", target["promised"]), *(("rehearsed", own["name"] or own["code"], own) for own in target["rehearsed"])]
        for proof, conditions, shown in [*proofs, ("achieved", "", target["achieved"])]:
            if shown is None:
                continue
            counts = [shown["photos"], sum(own["count"] for own in shown["not_counted"])]
            for row in shown["coverage"]["components"]:
                names = ("component", "number", "area_m2", "shown", "reachable", "gsd_mm", "angle_deg", "limit")
                yield map(cell, [*head, proof, conditions, *counts, *(_rounded(row[name]) for name in names)])


def _rounded(value: Value) -> Value:
    return round(value, 4) if isinstance(value, float) else value
