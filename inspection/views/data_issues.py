"""Data issues: the list, and curators' actions."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from django.http import Http404
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import DataIssueKind, DataIssueState
from inspection.selectors.data_issues import WORST_FIRST, DrawnIssue, issue_summary, issues
from inspection.serializers.data_issues import (
    DataIssueCollectionSerializer,
    DataIssueFeatureSerializer,
    DataIssueSummarySerializer,
    DismissSerializer,
    RepairedSerializer,
    RepairSerializer,
    UndoRepairSerializer,
    issue_feature,
    offer_json,
    repaired_json,
    summary_json,
)
from inspection.services.data_issues import dismiss_issue, find_issues_at_once, issues_are_current, reopen_issue
from inspection.services.history import CannotUndo
from inspection.services.repair_edits import CannotRepair
from inspection.services.repairs import offers_of, preview_of, repair_issue, undo_repair
from inspection.views.parameters import BOX, box_of, invalid, text_of
from workspace.api.errors import ApiProblem
from workspace.api.paging import asked_choice, page_of
from workspace.api.permissions import CURATORS
from workspace.api.schema import PAGE_PARAMETERS, several_of
from workspace.api.signed_in import SignedInRequest
from workspace.models import User

CANNOT = {409: OpenApiResponse(description="The ground has changed since, or somebody has decided already.")}


class DataIssueList(APIView):
    @extend_schema(
        operation_id="list_data_issues",
        summary="Where the data looks wrong, what cuts off most first",
        parameters=[
            BOX,
            OpenApiParameter(
                "kind", several_of(DataIssueKind.values), description=f"one or several of {', '.join(DataIssueKind.values)}, with commas"
            ),
            OpenApiParameter("state", str, enum=DataIssueState.values),
            OpenApiParameter("text", str, description="words in name, ref or operator of the asset, as for assets"),
            *PAGE_PARAMETERS,
        ],
        responses=DataIssueCollectionSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        found = issues(kinds=_kinds(request), state=_state(request), box=box_of(request), text=text_of(request))
        page = page_of(request, found, order=WORST_FIRST)
        features = [issue_feature(issue, [offer_json(offer) for offer in offers_of(issue)], request.user) for issue in page.rows]
        return Response({"type": "FeatureCollection", "features": features, "next": page.next})


class DataIssueCounts(APIView):
    @extend_schema(
        operation_id="get_data_issue_summary", summary="How many issues there are of each kind", responses=DataIssueSummarySerializer
    )
    def get(self, request: Request) -> Response:
        return Response(summary_json(issue_summary(), is_current=issues_are_current()))


class DataIssueDetail(APIView):
    @extend_schema(
        operation_id="get_data_issue", summary="One issue, with what each repair would draw", responses=DataIssueFeatureSerializer
    )
    def get(self, request: SignedInRequest, issue_id: int) -> Response:
        return Response(_feature(_issue(issue_id), request.user))


class DataIssueRepair(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="repair_data_issue",
        summary="Repair an issue",
        description="The changes are kept over the next import and stand in the history; `entries` names them, for undo.",
        request=RepairSerializer,
        responses={200: RepairedSerializer} | CANNOT,
    )
    def post(self, request: SignedInRequest, issue_id: int) -> Response:
        body = RepairSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        parameters = dict(body.validated_data)
        with _repairs():
            repaired = repair_issue(issue=_issue(issue_id), action=parameters.pop("action"), parameters=parameters, actor=request.user)
        is_current = find_issues_at_once()
        return Response(repaired_json(repaired, _feature_now(issue_id, request.user), is_current=is_current))


class DataIssueUndo(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="undo_repair",
        summary="Take a repair back, all of it or nothing",
        request=UndoRepairSerializer,
        responses={200: DataIssueFeatureSerializer, 204: OpenApiResponse(description="The issue has gone with its asset.")} | CANNOT,
    )
    def post(self, request: SignedInRequest, issue_id: int) -> Response:
        body = UndoRepairSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        with _repairs():
            undo_repair(issue=_issue(issue_id), entries=body.validated_data["entries"], actor=request.user)
        find_issues_at_once()
        feature = _feature_now(issue_id, request.user)
        return Response(feature) if feature else Response(status=204)


class DataIssueDismiss(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="dismiss_data_issue",
        summary="Leave it as it is",
        request=DismissSerializer,
        responses={200: DataIssueFeatureSerializer},
    )
    def post(self, request: SignedInRequest, issue_id: int) -> Response:
        body = DismissSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        dismiss_issue(issue=_issue(issue_id), note=body.validated_data["note"], actor=request.user)
        return Response(_feature(_issue(issue_id), request.user))


class DataIssueReopen(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="reopen_data_issue", summary="Put it on the open list again", request=None, responses={200: DataIssueFeatureSerializer}
    )
    def post(self, request: SignedInRequest, issue_id: int) -> Response:
        reopen_issue(issue=_issue(issue_id), actor=request.user)
        return Response(_feature(_issue(issue_id), request.user))


@contextmanager
def _repairs() -> Iterator[None]:
    """Translate the errors of repairs to responses."""
    try:
        yield
    except CannotRepair as error:
        raise ApiProblem(409, "cannot_repair", str(error)) from error
    except CannotUndo as error:
        raise ApiProblem(409, "cannot_undo", str(error)) from error


def _issue(issue_id: int) -> DrawnIssue:
    issue = issues().filter(pk=issue_id).first()
    if issue is None:
        raise Http404
    return issue


def _feature(issue: DrawnIssue, reader: User) -> dict[str, Any]:
    repairs = []
    for offer in offers_of(issue):
        preview, refused = None, ""
        if not offer.parameter or offer.parameter == "positions" or issue.details.get("offered_v"):
            try:
                preview = preview_of(issue=issue, action=offer.action, parameters={})
            except CannotRepair as error:
                refused = str(error)
        repairs.append(offer_json(offer, preview, refused))
    return issue_feature(issue, repairs, reader)


def _feature_now(issue_id: int, reader: User) -> dict[str, Any] | None:
    """Return the feature; None when the issue was deleted with its asset."""
    issue = issues().filter(pk=issue_id).first()
    return _feature(issue, reader) if issue else None


def _kinds(request: Request) -> list[DataIssueKind]:
    try:
        return [DataIssueKind(kind.strip()) for kind in request.query_params.get("kind", "").split(",") if kind.strip()]
    except ValueError as error:
        raise invalid("kind", _("Known kinds are %(value)s.") % {"value": ", ".join(DataIssueKind.values)}) from error


def _state(request: Request) -> DataIssueState | None:
    text = asked_choice(request, "state", DataIssueState.values)
    return DataIssueState(text) if text else None
