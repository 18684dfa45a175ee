"""UAV types and bases."""

from typing import Any

from django.http import Http404
from django.urls import reverse
from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from missions import services
from missions.models import Base, UavType
from missions.selectors import fleet
from missions.serializers.fleet import (
    BasePageSerializer,
    BaseSerializer,
    UavTypePageSerializer,
    UavTypeSerializer,
    base_json,
    uav_type_json,
)
from missions.views.problems import CHANGE_ANSWERS, DELETE_ANSWERS, RESTORE_CONFLICT, TAKEN, fleet_problems
from workspace.api.idempotency import idempotent
from workspace.api.paging import changed_since, page_of
from workspace.api.preconditions import IF_MATCH_REQUIRED, etag_of, expected_revision
from workspace.api.schema import CHANGED_SINCE, PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.models import User

TEXT = OpenApiParameter("text", str, description="part of the name")


def _text(request: Request) -> str:
    return request.query_params.get("text", "").strip()[:100].replace("\0", "")


def _type(user: User, type_id: int) -> UavType:
    row = fleet.types_of_organisation(user.organisation).filter(pk=type_id).first()
    if row is None:
        raise Http404
    return row


def _type_answer(user: User, type_id: int, *, status: int = 200) -> Response:
    row = _type(user, type_id)
    headers = etag_of(row.revision) | ({"Location": reverse("api-uav-type", args=[row.pk])} if status == 201 else {})
    return Response(uav_type_json(row), status=status, headers=headers)


def _type_now(user: User, type_id: int) -> Any:
    row = fleet.types_of_organisation(user.organisation).filter(pk=type_id).first()
    return uav_type_json(row) if row else None


class UavTypeList(APIView):
    @extend_schema(
        operation_id="list_uav_types",
        summary="UAV types, by name",
        parameters=[TEXT, CHANGED_SINCE, *PAGE_PARAMETERS],
        responses=UavTypePageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        types = fleet.types_of_organisation(request.user.organisation, text=_text(request))
        page = page_of(request, changed_since(request, types), order=("name", "pk"))
        return Response({"results": [uav_type_json(row) for row in page.rows], "next": page.next})

    @extend_schema(
        operation_id="create_uav_type", summary="Add a UAV type", request=UavTypeSerializer, responses={201: UavTypeSerializer, **TAKEN}
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        serializer = UavTypeSerializer(data=request.data)
        serializer.is_valid(raise_exception=True)
        with fleet_problems():
            row = services.create_uav_type(organisation=request.user.organisation, actor=request.user, values=serializer.validated_data)
        return _type_answer(request.user, row.pk, status=201)


class UavTypeDetail(APIView):
    @extend_schema(operation_id="get_uav_type", summary="One UAV type", responses=UavTypeSerializer)
    def get(self, request: SignedInRequest, type_id: int) -> Response:
        return _type_answer(request.user, type_id)

    @extend_schema(
        operation_id="change_uav_type",
        summary="Change a UAV type",
        description="UAVs without a range or speed of their own follow it. Plans that were made stay as they are.",
        parameters=[IF_MATCH_REQUIRED],
        request=UavTypeSerializer,
        responses={200: UavTypeSerializer, **CHANGE_ANSWERS},
    )
    def patch(self, request: SignedInRequest, type_id: int) -> Response:
        row, revision = _type(request.user, type_id), expected_revision(request)
        serializer = UavTypeSerializer(row, data=request.data, partial=True)
        serializer.is_valid(raise_exception=True)
        with fleet_problems(lambda: _type_now(request.user, type_id)):
            services.change_uav_type(uav_type=row, actor=request.user, values=serializer.validated_data, expected_revision=revision)
        return _type_answer(request.user, type_id)

    @extend_schema(
        operation_id="delete_uav_type",
        summary="Remove a UAV type that no UAV is of",
        parameters=[IF_MATCH_REQUIRED],
        responses=DELETE_ANSWERS,
    )
    def delete(self, request: SignedInRequest, type_id: int) -> Response:
        row, revision = _type(request.user, type_id), expected_revision(request)
        with fleet_problems(lambda: _type_now(request.user, type_id)):
            services.delete_uav_type(uav_type=row, actor=request.user, expected_revision=revision)
        return Response(status=204)


class UavTypeRestore(APIView):
    @extend_schema(
        operation_id="restore_uav_type",
        summary="Bring a deleted UAV type back",
        request=None,
        responses={200: UavTypeSerializer, **RESTORE_CONFLICT},
    )
    def post(self, request: SignedInRequest, type_id: int) -> Response:
        with fleet_problems():
            services.restore_uav_type(organisation=request.user.organisation, actor=request.user, key=type_id)
        return _type_answer(request.user, type_id)


def _base(user: User, base_id: int) -> Base:
    row = fleet.bases_of_organisation(user.organisation).filter(pk=base_id).first()
    if row is None:
        raise Http404
    return row


def _base_answer(user: User, base_id: int, *, status: int = 200) -> Response:
    row = _base(user, base_id)
    headers = etag_of(row.revision) | ({"Location": reverse("api-base", args=[row.pk])} if status == 201 else {})
    return Response(base_json(row), status=status, headers=headers)


def _base_now(user: User, base_id: int) -> Any:
    row = fleet.bases_of_organisation(user.organisation).filter(pk=base_id).first()
    return base_json(row) if row else None


class BaseList(APIView):
    @extend_schema(
        operation_id="list_bases",
        summary="Bases, by name",
        parameters=[TEXT, CHANGED_SINCE, *PAGE_PARAMETERS],
        responses=BasePageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        bases = fleet.bases_of_organisation(request.user.organisation, text=_text(request))
        page = page_of(request, changed_since(request, bases), order=("name", "pk"))
        return Response({"results": [base_json(row) for row in page.rows], "next": page.next})

    @extend_schema(operation_id="create_base", summary="Add a base", request=BaseSerializer, responses={201: BaseSerializer, **TAKEN})
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        serializer = BaseSerializer(data=request.data)
        serializer.is_valid(raise_exception=True)
        values = dict(serializer.validated_data)
        with fleet_problems():
            position = values.pop("position")
            row = services.create_base(organisation=request.user.organisation, actor=request.user, position=position, values=values)
        return _base_answer(request.user, row.pk, status=201)


class BaseDetail(APIView):
    @extend_schema(operation_id="get_base", summary="One base", responses=BaseSerializer)
    def get(self, request: SignedInRequest, base_id: int) -> Response:
        return _base_answer(request.user, base_id)

    @extend_schema(
        operation_id="change_base",
        summary="Change a base",
        description="Its UAVs follow a new name. Where they stand is theirs and stays.",
        parameters=[IF_MATCH_REQUIRED],
        request=BaseSerializer,
        responses={200: BaseSerializer, **CHANGE_ANSWERS},
    )
    def patch(self, request: SignedInRequest, base_id: int) -> Response:
        row, revision = _base(request.user, base_id), expected_revision(request)
        serializer = BaseSerializer(data=request.data, partial=True)
        serializer.is_valid(raise_exception=True)
        values = dict(serializer.validated_data)
        position = values.pop("position", None)
        with fleet_problems(lambda: _base_now(request.user, base_id)):
            services.change_base(base=row, actor=request.user, position=position, values=values, expected_revision=revision)
        return _base_answer(request.user, base_id)

    @extend_schema(
        operation_id="delete_base", summary="Remove a base that no UAV has", parameters=[IF_MATCH_REQUIRED], responses=DELETE_ANSWERS
    )
    def delete(self, request: SignedInRequest, base_id: int) -> Response:
        row, revision = _base(request.user, base_id), expected_revision(request)
        with fleet_problems(lambda: _base_now(request.user, base_id)):
            services.delete_base(base=row, actor=request.user, expected_revision=revision)
        return Response(status=204)


class BaseRestore(APIView):
    @extend_schema(
        operation_id="restore_base",
        summary="Bring a deleted base back",
        request=None,
        responses={200: BaseSerializer, **RESTORE_CONFLICT},
    )
    def post(self, request: SignedInRequest, base_id: int) -> Response:
        with fleet_problems():
            services.restore_base(organisation=request.user.organisation, actor=request.user, key=base_id)
        return _base_answer(request.user, base_id)
