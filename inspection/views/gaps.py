"""Gaps in the data of the ground: the list, and what a curator does about one."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from django.http import Http404
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import GapKind, GapState
from inspection.selectors.gaps import WORST_FIRST, DrawnGap, gap_summary, gaps
from inspection.serializers.gaps import (
    DismissSerializer,
    GapCollectionSerializer,
    GapFeatureSerializer,
    GapSummarySerializer,
    RepairedSerializer,
    RepairSerializer,
    UndoRepairSerializer,
    gap_feature,
    offer_json,
    repaired_json,
    summary_json,
)
from inspection.services.gaps import dismiss_gap, find_gaps_at_once, gaps_are_current, reopen_gap
from inspection.services.history import CannotUndo
from inspection.services.repair_edits import CannotRepair
from inspection.services.repairs import offers_of, preview_of, repair_gap, undo_repair
from inspection.views.parameters import BOX, box_of, invalid, text_of
from workspace.api.errors import ApiProblem
from workspace.api.paging import asked_choice, page_of
from workspace.api.permissions import CURATORS
from workspace.api.schema import PAGE_PARAMETERS, several_of
from workspace.api.signed_in import SignedInRequest
from workspace.models import User

CANNOT = {409: OpenApiResponse(description="The ground has changed since, or somebody has decided already.")}


class GapList(APIView):
    @extend_schema(
        operation_id="list_gaps",
        summary="Where the data looks wrong, what cuts off most first",
        parameters=[
            BOX,
            OpenApiParameter("kind", several_of(GapKind.values), description=f"one or several of {', '.join(GapKind.values)}, with commas"),
            OpenApiParameter("state", str, enum=GapState.values),
            OpenApiParameter("text", str, description="words in name, ref or operator of the asset, as for assets"),
            *PAGE_PARAMETERS,
        ],
        responses=GapCollectionSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        found = gaps(kinds=_kinds(request), state=_state(request), box=box_of(request), text=text_of(request))
        page = page_of(request, found, order=WORST_FIRST)
        features = [gap_feature(gap, [offer_json(offer) for offer in offers_of(gap)], request.user) for gap in page.rows]
        return Response({"type": "FeatureCollection", "features": features, "next": page.next})


class GapCounts(APIView):
    @extend_schema(operation_id="get_gap_summary", summary="How many gaps there are of each kind", responses=GapSummarySerializer)
    def get(self, request: Request) -> Response:
        return Response(summary_json(gap_summary(), is_current=gaps_are_current()))


class GapDetail(APIView):
    @extend_schema(operation_id="get_gap", summary="One gap, with what each repair would draw", responses=GapFeatureSerializer)
    def get(self, request: SignedInRequest, gap_id: int) -> Response:
        return Response(_feature(_gap(gap_id), request.user))


class GapRepair(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="repair_gap",
        summary="Repair a gap",
        description="The changes are kept over the next import and stand in the history; `entries` names them, for undo.",
        request=RepairSerializer,
        responses={200: RepairedSerializer} | CANNOT,
    )
    def post(self, request: SignedInRequest, gap_id: int) -> Response:
        body = RepairSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        parameters = dict(body.validated_data)
        with _repairs():
            repaired = repair_gap(gap=_gap(gap_id), action=parameters.pop("action"), parameters=parameters, actor=request.user)
        is_current = find_gaps_at_once()
        return Response(repaired_json(repaired, _feature_now(gap_id, request.user), is_current=is_current))


class GapUndo(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="undo_repair",
        summary="Take a repair back, all of it or nothing",
        request=UndoRepairSerializer,
        responses={200: GapFeatureSerializer, 204: OpenApiResponse(description="The gap has gone with its asset.")} | CANNOT,
    )
    def post(self, request: SignedInRequest, gap_id: int) -> Response:
        body = UndoRepairSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        with _repairs():
            undo_repair(gap=_gap(gap_id), entries=body.validated_data["entries"], actor=request.user)
        find_gaps_at_once()
        feature = _feature_now(gap_id, request.user)
        return Response(feature) if feature else Response(status=204)


class GapDismiss(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="dismiss_gap", summary="Leave it as it is", request=DismissSerializer, responses={200: GapFeatureSerializer}
    )
    def post(self, request: SignedInRequest, gap_id: int) -> Response:
        body = DismissSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        dismiss_gap(gap=_gap(gap_id), note=body.validated_data["note"], actor=request.user)
        return Response(_feature(_gap(gap_id), request.user))


class GapReopen(APIView):
    write_roles = CURATORS

    @extend_schema(operation_id="reopen_gap", summary="Put it on the open list again", request=None, responses={200: GapFeatureSerializer})
    def post(self, request: SignedInRequest, gap_id: int) -> Response:
        reopen_gap(gap=_gap(gap_id), actor=request.user)
        return Response(_feature(_gap(gap_id), request.user))


@contextmanager
def _repairs() -> Iterator[None]:
    """Turns the errors of repairs into answers."""
    try:
        yield
    except CannotRepair as error:
        raise ApiProblem(409, "cannot_repair", str(error)) from error
    except CannotUndo as error:
        raise ApiProblem(409, "cannot_undo", str(error)) from error


def _gap(gap_id: int) -> DrawnGap:
    gap = gaps().filter(pk=gap_id).first()
    if gap is None:
        raise Http404
    return gap


def _feature(gap: DrawnGap, reader: User) -> dict[str, Any]:
    repairs = []
    for offer in offers_of(gap):
        preview, refused = None, ""
        if not offer.parameter or offer.parameter == "positions" or gap.details.get("offered_v"):
            try:
                preview = preview_of(gap=gap, action=offer.action, parameters={})
            except CannotRepair as error:
                refused = str(error)
        repairs.append(offer_json(offer, preview, refused))
    return gap_feature(gap, repairs, reader)


def _feature_now(gap_id: int, reader: User) -> dict[str, Any] | None:
    """None when the gap has gone with its asset."""
    gap = gaps().filter(pk=gap_id).first()
    return _feature(gap, reader) if gap else None


def _kinds(request: Request) -> list[GapKind]:
    try:
        return [GapKind(kind.strip()) for kind in request.query_params.get("kind", "").split(",") if kind.strip()]
    except ValueError as error:
        raise invalid("kind", _("Known kinds are %(value)s.") % {"value": ", ".join(GapKind.values)}) from error


def _state(request: Request) -> GapState | None:
    text = asked_choice(request, "state", GapState.values)
    return GapState(text) if text else None
