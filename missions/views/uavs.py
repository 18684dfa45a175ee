"""UAVs as GeoJSON."""

from typing import Any

from django.http import Http404
from django.urls import reverse
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, PolymorphicProxySerializer, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from missions import services
from missions.models import Uav, UavState
from missions.selectors import fleet
from missions.serializers.fleet import UavMissionPageSerializer
from missions.serializers.uavs import UavCollectionSerializer, UavFeatureSerializer, UavFlatSerializer, flat_uav, uav_feature
from missions.views.problems import CHANGE_ANSWERS, DELETE_ANSWERS, RESTORE_CONFLICT, TAKEN, fleet_problems, refusals
from workspace.api.errors import ApiProblem
from workspace.api.external_data import EXTERNAL_ID, asked_external_id
from workspace.api.idempotency import idempotent
from workspace.api.paging import asked_choice, asked_flag, changed_since, page_of
from workspace.api.permissions import ADMINISTRATORS
from workspace.api.preconditions import IF_MATCH_REQUIRED, etag_of, expected_revision
from workspace.api.schema import CHANGED_SINCE, PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.api.whole_numbers import WholeNumber
from workspace.models import User

STATES = (*UavState.values, fleet.EVERY_STATE)
BASE, TYPE = WholeNumber("base"), WholeNumber("type")
WAIVES_SAFETY = ("is_simulated", "allows_unsigned")

INPUT = PolymorphicProxySerializer(
    component_name="UavWrite", serializers=[UavFlatSerializer, UavFeatureSerializer], resource_type_field_name=None
)


def uav_or_404(user: User, uav_id: int) -> fleet.UavWithUse:
    uav = _uav_now(user, uav_id)
    if uav is None:
        raise Http404
    return uav


def _uav_now(user: User, uav_id: int) -> fleet.UavWithUse | None:
    return fleet.with_use(fleet.uavs_of_organisation(user.organisation)).filter(pk=uav_id).first()


def _feature_now(user: User, uav_id: int) -> Any:
    uav = _uav_now(user, uav_id)
    return uav_feature(uav) if uav else None


def _answer(user: User, uav_id: int, *, status: int = 200) -> Response:
    uav = uav_or_404(user, uav_id)
    headers = etag_of(uav.revision) | ({"Location": reverse("api-uav", args=[uav.pk])} if status == 201 else {})
    return Response(uav_feature(uav), status=status, headers=headers)


def _values(request: SignedInRequest, uav: Uav | None = None) -> dict[str, Any]:
    """Return the values of a new UAV, or the changes of a stored one."""
    context = {"organisation": request.user.organisation}
    serializer = UavFlatSerializer(uav, data=flat_uav(request.data), partial=uav is not None, context=context)
    serializer.is_valid(raise_exception=True)
    values = dict(serializer.validated_data)
    changed = [name for name in WAIVES_SAFETY if values.get(name, getattr(uav, name, False)) != getattr(uav, name, False)]
    if changed and request.user.role not in ADMINISTRATORS:
        raise ApiProblem(403, "permission_denied", _("Only administrators say that a UAV is simulated, or needs no signature."))
    return values


def _filters(request: Request) -> dict[str, Any]:
    """Return the filters. Raises ApiProblem for an invalid state or id."""
    words = {name: request.query_params.get(name, "").strip()[:100].replace("\0", "") for name in ("text", "state", "sensor")}
    asked_choice(request, "state", STATES)
    ids = {"base": BASE.asked(request), "uav_type": TYPE.asked(request)}
    return words | ids | {"external_id": asked_external_id(request), "twins": bool(asked_flag(request, "twins"))}


class UavList(APIView):
    @extend_schema(
        operation_id="list_uavs",
        summary="UAVs of one's organisation, by name",
        parameters=[
            OpenApiParameter("text", str, description="part of the name, the base's name, the type's name or the serial number"),
            OpenApiParameter("state", str, enum=STATES, description="without it all but the retired ones"),
            BASE.documented,
            TYPE.documented,
            OpenApiParameter("sensor", str, description="part of the name of one of its sensors"),
            OpenApiParameter("twins", bool, description="also the simulated twins that fly copies of missions"),
            EXTERNAL_ID,
            CHANGED_SINCE,
            *PAGE_PARAMETERS,
        ],
        responses=UavCollectionSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        filters = _filters(request)
        found = fleet.uavs_that_match(request.user.organisation, **filters)
        in_any_state = fleet.uavs_that_match(request.user.organisation, **filters | {"state": fleet.EVERY_STATE})
        page = page_of(request, fleet.with_use(changed_since(request, found)), order=("name", "pk"))
        return Response(
            {
                "type": "FeatureCollection",
                "features": [uav_feature(uav) for uav in page.rows],
                "numbers": fleet.numbers_by_state(in_any_state),
                "next": page.next,
            }
        )

    @extend_schema(operation_id="create_uav", summary="Register a UAV", request=INPUT, responses={201: UavFeatureSerializer, **TAKEN})
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        values = _values(request)
        position = values.pop("position", None)
        with fleet_problems():
            uav = services.create_uav(organisation=request.user.organisation, actor=request.user, position=position, values=values)
        return _answer(request.user, uav.pk, status=201)


class UavDetail(APIView):
    @extend_schema(operation_id="get_uav", summary="One UAV", responses=UavFeatureSerializer)
    def get(self, request: SignedInRequest, uav_id: int) -> Response:
        return _answer(request.user, uav_id)

    @extend_schema(
        operation_id="change_uav",
        summary="Change a UAV, retire it, bring it back",
        description="A retired UAV is not offered for new missions; those that have it keep it.",
        parameters=[IF_MATCH_REQUIRED],
        request=INPUT,
        responses={200: UavFeatureSerializer, **CHANGE_ANSWERS},
    )
    def patch(self, request: SignedInRequest, uav_id: int) -> Response:
        uav, revision = uav_or_404(request.user, uav_id), expected_revision(request)
        values = _values(request, uav)
        position = values.pop("position", None)
        with fleet_problems(lambda: _feature_now(request.user, uav_id)), refusals():
            services.change_uav(uav=uav, actor=request.user, position=position, values=values, expected_revision=revision)
        return _answer(request.user, uav_id)

    @extend_schema(
        operation_id="delete_uav",
        summary="Remove a UAV that no mission uses",
        description="Its credentials go with it and do not come back. One that flies or waits for a command stays (409).",
        parameters=[IF_MATCH_REQUIRED],
        responses=DELETE_ANSWERS,
    )
    def delete(self, request: SignedInRequest, uav_id: int) -> Response:
        uav, revision = uav_or_404(request.user, uav_id), expected_revision(request)
        with fleet_problems(lambda: _feature_now(request.user, uav_id)), refusals():
            services.delete_uav(uav=uav, actor=request.user, expected_revision=revision)
        return Response(status=204)


class UavRestore(APIView):
    @extend_schema(
        operation_id="restore_uav",
        summary="Bring a deleted UAV back, without credentials",
        request=None,
        responses={200: UavFeatureSerializer, **RESTORE_CONFLICT},
    )
    def post(self, request: SignedInRequest, uav_id: int) -> Response:
        with fleet_problems():
            services.restore_uav(organisation=request.user.organisation, actor=request.user, key=uav_id)
        return _answer(request.user, uav_id)


class UavMissions(APIView):
    @extend_schema(
        operation_id="list_missions_of_uav",
        summary="Missions that use a UAV, the last changed first",
        parameters=PAGE_PARAMETERS,
        responses=UavMissionPageSerializer,
    )
    def get(self, request: SignedInRequest, uav_id: int) -> Response:
        missions = fleet.missions_of_uav(uav_or_404(request.user, uav_id))
        page = page_of(request, missions, order=("-updated_at", "-pk"), default_limit=20)
        return Response({"results": [_mission_json(mission) for mission in page.rows], "next": page.next})


def _mission_json(mission: Any) -> dict[str, Any]:
    return {"id": str(mission.pk), "name": mission.name, "state": mission.state, "updated_at": mission.updated_at}
