"""Findings: list, detail, change, evidence, observations, comments, history."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from uuid import UUID

from django.shortcuts import get_object_or_404
from django.urls import reverse
from django.utils.translation import gettext as _
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import Asset
from inspection.views.parameters import invalid
from missions.serializers.changes import HistoryEntrySerializer, HistoryPageSerializer
from missions.serializers.shapes import MissionSerializer
from missions.views.missions import answer_mission
from missions.views.problems import api_problems
from results.categories import BY_CODE, SCHEME
from results.finding_states import FindingState
from results.models import Finding, Medium
from results.selectors.findings import FindingFilter, findings_of_organisation, findings_that_match, history_of_finding
from results.selectors.media import media_of_organisation
from results.serializers import findings as shapes
from results.services.findings import (
    FindingChanged,
    FindingRefused,
    Mark,
    add_evidence,
    change_finding,
    comment_finding,
    create_finding,
    observe_finding,
    remove_evidence,
)
from results.services.look_again import draft_look_again
from results.views.media import ASSET, uuid_of
from results.views.subjects import subject_of
from workspace.api.errors import ApiProblem
from workspace.api.idempotency import idempotent
from workspace.api.paging import asked_choice, asked_instant, page_of
from workspace.api.preconditions import IF_MATCH_REQUIRED, PRECONDITION_ANSWERS, etag_of, expected_revision
from workspace.api.schema import PAGE_PARAMETERS, several_of
from workspace.api.signed_in import SignedInRequest

STATES = [state.value for state in FindingState]
SEVERITIES = ["1", "2", "3", "4"]
WORST_FIRST = ("severity", "-created_at", "pk")
FILTERS = [
    OpenApiParameter("state", several_of(STATES), description=f"one or several with commas: {', '.join(STATES)}"),
    OpenApiParameter("severity", several_of(SEVERITIES), description="one or several with commas"),
    OpenApiParameter("category", str, enum=list(BY_CODE)),
    ASSET.documented,
    OpenApiParameter("mission", UUID, description="id of a mission"),
    OpenApiParameter("medium", UUID, description="id of a photo that shows it"),
    OpenApiParameter("due_before", OpenApiTypes.DATE, description="due before this day"),
]
REFUSED = {409: OpenApiResponse(description="`refused`: it contradicts the finding; `details` names the field.")}


class FindingCategories(APIView):
    @extend_schema(
        operation_id="list_finding_categories",
        summary="The list of categories, in your language",
        responses=shapes.CategoryListSerializer,
    )
    def get(self, request: Request) -> Response:
        return Response({"scheme": SCHEME, "categories": shapes.categories_json(_)})


class FindingList(APIView):
    @extend_schema(
        operation_id="list_findings",
        summary="Findings, the worst first",
        parameters=[*FILTERS, *PAGE_PARAMETERS],
        responses=shapes.InspectionFindingPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        page = page_of(request, findings_that_match(request.user.organisation_id, asked_findings(request)), order=WORST_FIRST)
        return Response({"results": [shapes.finding_json(row, category_name(row)) for row in page.rows], "next": page.next})

    @extend_schema(
        operation_id="create_finding",
        summary="Create a finding, with marks on photos",
        request=shapes.FindingInputSerializer,
        responses={201: shapes.InspectionFindingDetailSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        body = shapes.FindingInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        values = dict(body.validated_data)
        subject = subject_of(request.user, values)
        marks = [_mark(request, mark) for mark in values.pop("evidence", [])]
        for name in ("mission", "target", "asset"):
            values.pop(name, None)
        with finding_problems():
            finding = create_finding(
                actor=request.user, marks=marks, mission=subject.mission, target=subject.target, asset=subject.asset, **values
            )
        return _answer(request, finding.pk, status=201)


class FindingsLookAgain(APIView):
    @extend_schema(
        operation_id="look_again_at_findings",
        summary="A draft mission that looks at findings again",
        description="Of the targets on which they were made, each once, with the tasks, photos and UAVs of then; of a finding without one, "
        "its asset. A finding that is done is verified by these photos.",
        request=shapes.LookAgainSerializer,
        responses={201: MissionSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        body = shapes.LookAgainSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        asked = list(dict.fromkeys(body.validated_data["findings"]))
        rows = findings_of_organisation(request.user.organisation_id).in_bulk(asked)
        if len(rows) < len(asked):
            raise invalid("findings", _("There is no such finding."))
        with finding_problems(), api_problems():
            draft = draft_look_again(findings=[rows[key] for key in asked], actor=request.user, name=body.validated_data.get("name", ""))
        return answer_mission(request.user, draft.pk, status=201)


class FindingDetail(APIView):
    @extend_schema(
        operation_id="get_finding",
        summary="A finding with its evidence, observations and comments",
        responses=shapes.InspectionFindingDetailSerializer,
    )
    def get(self, request: SignedInRequest, finding_id: UUID) -> Response:
        return _answer(request, finding_id)

    @extend_schema(
        operation_id="change_finding",
        summary="Change a finding",
        description="`verified` cannot be set: it follows from an observation on a photo that was taken after the work was done.",
        parameters=[IF_MATCH_REQUIRED],
        request=shapes.FindingChangeSerializer,
        responses={200: shapes.InspectionFindingDetailSerializer, **REFUSED, **PRECONDITION_ANSWERS},
    )
    def patch(self, request: SignedInRequest, finding_id: UUID) -> Response:
        finding, revision = _finding(request, finding_id), expected_revision(request)
        body = shapes.FindingChangeSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        values = dict(body.validated_data)
        if "asset" in values:
            values["asset"] = subject_of(request.user, {"asset": values["asset"]}).asset
        with finding_problems(request, finding_id):
            change_finding(finding=finding, actor=request.user, values=values, expected_revision=revision)
        return _answer(request, finding_id)


class FindingEvidence(APIView):
    @extend_schema(
        operation_id="add_evidence",
        summary="Mark where another photo shows the finding",
        request=shapes.MarkSerializer,
        responses={201: shapes.InspectionFindingDetailSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest, finding_id: UUID) -> Response:
        finding = _finding(request, finding_id)
        body = shapes.MarkSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        with finding_problems():
            add_evidence(finding=finding, actor=request.user, mark=_mark(request, body.validated_data))
        return _answer(request, finding_id, status=201)


class FindingEvidenceDetail(APIView):
    @extend_schema(
        operation_id="remove_evidence", summary="Remove a mark; the photo stays", responses={200: shapes.InspectionFindingDetailSerializer}
    )
    def delete(self, request: SignedInRequest, finding_id: UUID, evidence_id: int) -> Response:
        marks = _finding(request, finding_id).evidence.select_related("medium", "finding")
        evidence = get_object_or_404(marks, pk=evidence_id)
        remove_evidence(evidence=evidence, actor=request.user)
        return _answer(request, finding_id)


class FindingObservations(APIView):
    @extend_schema(
        operation_id="observe_finding",
        summary="State that a later photo shows the finding, or does not",
        description="A finding that is done and not seen becomes verified; seen again it is open again.",
        request=shapes.ObservationInputSerializer,
        responses={201: shapes.InspectionFindingDetailSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest, finding_id: UUID) -> Response:
        finding = _finding(request, finding_id)
        body = shapes.ObservationInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        medium = _medium(request, body.validated_data["medium"])
        with finding_problems():
            observe_finding(finding=finding, actor=request.user, medium=medium, outcome=body.validated_data["outcome"])
        return _answer(request, finding_id, status=201)


class FindingComments(APIView):
    @extend_schema(
        operation_id="comment_finding",
        summary="Comment on a finding",
        request=shapes.CommentInputSerializer,
        responses={201: shapes.FindingCommentSerializer},
    )
    @idempotent
    def post(self, request: SignedInRequest, finding_id: UUID) -> Response:
        finding = _finding(request, finding_id)
        body = shapes.CommentInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        comment = comment_finding(finding=finding, actor=request.user, text=body.validated_data["text"])
        return Response(shapes.comment_json(comment), status=201)


class FindingHistory(APIView):
    @extend_schema(
        operation_id="list_finding_history",
        summary="Who changed what in a finding, the newest first",
        parameters=PAGE_PARAMETERS,
        responses=HistoryPageSerializer,
    )
    def get(self, request: SignedInRequest, finding_id: UUID) -> Response:
        page = page_of(request, history_of_finding(_finding(request, finding_id)), order=("-recorded_at", "-pk"))
        return Response({"results": HistoryEntrySerializer(page.rows, many=True).data, "next": page.next})


@contextmanager
def finding_problems(request: SignedInRequest | None = None, finding_id: UUID | None = None) -> Iterator[None]:
    """Translate what the service raises."""
    try:
        yield
    except FindingChanged as error:
        current = _detail(request, finding_id) if request is not None and finding_id is not None else None
        raise ApiProblem(412, "changed", _("The finding was changed in the meantime."), details={"current": current}) from error
    except FindingRefused as error:
        raise ApiProblem(409, "refused", str(error), details={error.field: [str(error)]}) from error


def category_name(finding: Finding) -> str:
    """Return a category in the reader's language; its code where this version has no such category."""
    known = BY_CODE.get(finding.category)
    return finding.category if known is None else _(known.name)


def asked_findings(request: Request) -> FindingFilter:
    """Return the filter of a query. Raises ApiProblem 400."""
    asset_id = ASSET.asked(request)
    due_before = asked_instant(request, "due_before")
    return FindingFilter(
        states=_several(request, "state", STATES),
        severities=[int(text) for text in _several(request, "severity", SEVERITIES)],
        category=asked_choice(request, "category", list(BY_CODE)),
        asset=None if asset_id is None else get_object_or_404(Asset, pk=asset_id),
        mission=uuid_of(request, "mission"),
        medium=uuid_of(request, "medium"),
        due_before=None if due_before is None else due_before.date(),
    )


def _several(request: Request, name: str, known: list[str]) -> list[str]:
    found = [text for text in request.query_params.get(name, "").split(",") if text]
    if not set(found) <= set(known):
        raise invalid(name, _("Known are {names}.").format(names=", ".join(known)))
    return found


def _finding(request: SignedInRequest, finding_id: UUID) -> Finding:
    findings = findings_of_organisation(request.user.organisation_id).select_related("organisation", "created_by")
    return get_object_or_404(findings, pk=finding_id)


def _medium(request: SignedInRequest, medium_id: UUID) -> Medium:
    media = media_of_organisation(request.user.organisation_id).select_related("asset", "target__asset", "mission")
    found = media.filter(pk=medium_id).first()
    if found is None:
        raise invalid("medium", _("There is no such photo."))
    return found


def _mark(request: SignedInRequest, values: dict[str, Any]) -> Mark:
    shape = values.get("shape")
    return Mark(_medium(request, values["medium"]), None if shape is None else dict(shape))


def _detail(request: SignedInRequest, finding_id: UUID) -> dict[str, Any]:
    finding = _finding(request, finding_id)
    return shapes.detail_json(finding, category_name(finding))


def _answer(request: SignedInRequest, finding_id: UUID, *, status: int = 200) -> Response:
    found = _detail(request, finding_id)
    headers = etag_of(found["revision"]) | ({"Location": reverse("api-finding", args=[finding_id])} if status == 201 else {})
    return Response(found, status=status, headers=headers)
