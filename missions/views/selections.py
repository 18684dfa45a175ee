"""Saved selections: list, save, load, rename, change, delete."""

from collections.abc import Iterator
from contextlib import contextmanager

from django.http import Http404
from django.urls import reverse
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.models import SavedSelection
from missions.selectors.selections import selections_of_organisation
from missions.serializers.selections import (
    SelectionInputSerializer,
    SelectionPageSerializer,
    SelectionSerializer,
    selection_json,
    selection_summary,
)
from missions.services.selections import SelectionChanged, SelectionNameTaken, change_selection, create_selection, delete_selection
from missions.views.problems import api_problems
from workspace.api.errors import ApiProblem
from workspace.api.idempotency import idempotent
from workspace.api.paging import page_of
from workspace.api.preconditions import IF_MATCH_REQUIRED, PRECONDITION_ANSWERS, etag_of, expected_revision
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.models import User

NAME_TAKEN = {409: OpenApiResponse(description="Another selection has this name.")}


def _selection(user: User, selection_id: int) -> SavedSelection:
    selection = selections_of_organisation(user.organisation).filter(pk=selection_id).first()
    if selection is None:
        raise Http404
    return selection


def _answer(selection: SavedSelection, *, status: int = 200) -> Response:
    headers = etag_of(selection.revision)
    if status == 201:
        headers["Location"] = reverse("api-selection", args=[selection.pk])
    return Response(selection_json(selection), status=status, headers=headers)


@contextmanager
def _problems(user: User, selection_id: int | None = None) -> Iterator[None]:
    with api_problems():
        try:
            yield
        except SelectionNameTaken as error:
            raise ApiProblem(409, "name_taken", _("Another saved selection has this name.")) from error
        except SelectionChanged as error:
            now = None if selection_id is None else selections_of_organisation(user.organisation).filter(pk=selection_id).first()
            details = {"current": selection_json(now) if now else None}
            raise ApiProblem(412, "changed", _("The saved selection was changed in the meantime."), details=details) from error


class SelectionList(APIView):
    @extend_schema(
        operation_id="list_selections",
        summary="Saved selections of one's organisation, by name",
        parameters=[OpenApiParameter("text", str, description="part of the name"), *PAGE_PARAMETERS],
        responses=SelectionPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        text = request.query_params.get("text", "").strip()[:100].replace("\0", "")
        page = page_of(request, selections_of_organisation(request.user.organisation, text=text), order=("name", "pk"))
        return Response({"results": [selection_summary(selection) for selection in page.rows], "next": page.next})

    @extend_schema(
        operation_id="create_selection",
        summary="Keep targets under a name",
        request=SelectionInputSerializer,
        responses={201: SelectionSerializer, **NAME_TAKEN},
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        user = request.user
        body = SelectionInputSerializer(data=request.data, context={"organisation": user.organisation})
        body.is_valid(raise_exception=True)
        values = body.validated_data
        with _problems(user):
            selection = create_selection(organisation=user.organisation, author=user, name=values["name"], targets=values["targets"])
        return _answer(selection, status=201)


class SelectionDetail(APIView):
    @extend_schema(operation_id="get_selection", summary="A saved selection with its targets", responses=SelectionSerializer)
    def get(self, request: SignedInRequest, selection_id: int) -> Response:
        return _answer(_selection(request.user, selection_id))

    @extend_schema(
        operation_id="change_selection",
        summary="Rename a saved selection, or keep other targets in it",
        parameters=[IF_MATCH_REQUIRED],
        request=SelectionInputSerializer(partial=True),
        responses={200: SelectionSerializer, **NAME_TAKEN, **PRECONDITION_ANSWERS},
    )
    def patch(self, request: SignedInRequest, selection_id: int) -> Response:
        user = request.user
        expected = expected_revision(request)
        selection = _selection(user, selection_id)
        body = SelectionInputSerializer(data=request.data, partial=True, context={"organisation": user.organisation})
        body.is_valid(raise_exception=True)
        values = body.validated_data
        with _problems(user, selection_id):
            changed = change_selection(
                selection=selection, actor=user, name=values.get("name"), targets=values.get("targets"), expected_revision=expected
            )
        return _answer(changed)

    @extend_schema(
        operation_id="delete_selection",
        summary="Delete a saved selection",
        parameters=[IF_MATCH_REQUIRED],
        responses={204: None, **PRECONDITION_ANSWERS},
    )
    def delete(self, request: SignedInRequest, selection_id: int) -> Response:
        expected = expected_revision(request)
        selection = _selection(request.user, selection_id)
        with _problems(request.user, selection_id):
            delete_selection(selection=selection, actor=request.user, expected_revision=expected)
        return Response(status=204)
