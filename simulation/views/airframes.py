"""Simulated airframes, the airframe of a UAV type, and the rehearsal rule of approvals."""

from django.db import transaction
from django.shortcuts import get_object_or_404
from django.utils.translation import gettext as _
from drf_spectacular.utils import extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.views.parameters import invalid
from missions.models import UavType
from missions.selectors.fleet import types_of_organisation
from simulation import selectors
from simulation.flight.airframe import AIRFRAMES
from simulation.models import SimulatedAirframe
from simulation.rehearsing.airframe_choice import CANDIDATES
from simulation.selectors import chosen_airframe
from simulation.serializers import shapes
from simulation.services.fleet import airframe_of_type
from simulation.services.rehearsals import set_rule
from workspace.api.permissions import ADMINISTRATORS, InTheBrowserAlone
from workspace.api.signed_in import SignedInRequest
from workspace.audit import record_change
from workspace.models import User


class NoSuchAirframe(ValueError):
    """There is no airframe with this code."""


def choose_airframe(*, uav_type: UavType, airframe: str | None, actor: User) -> None:
    """Choose the airframe of a type; None: the nearest. Raises NoSuchAirframe."""
    if airframe is not None and airframe not in AIRFRAMES:
        raise NoSuchAirframe(airframe)
    with transaction.atomic():
        before = chosen_airframe(uav_type)
        if airframe is None:
            SimulatedAirframe.objects.filter(uav_type=uav_type).delete()
        else:
            SimulatedAirframe.objects.update_or_create(uav_type=uav_type, defaults={"airframe": airframe})
        if before != airframe:
            record_change(
                organisation=uav_type.organisation, actor=actor, action="changed", subject_type="uavtype", subject_id=uav_type.pk,
                before={"simulated_airframe": before}, after={"simulated_airframe": airframe},
            )  # fmt: skip


class Airframes(APIView):
    @extend_schema(
        operation_id="list_airframes", summary="Simulated airframes that can fly rehearsals", responses=shapes.AirframeListSerializer
    )
    def get(self, request: Request) -> Response:
        found = [
            {
                "code": candidate.code,
                "name": AIRFRAMES[candidate.code].name,
                "mass_kg": candidate.mass_kg,
                "battery_wh": AIRFRAMES[candidate.code].battery_wh,
                "max_airspeed_mps": AIRFRAMES[candidate.code].max_airspeed_mps,
                "hover_min": round(candidate.endurance_min, 1),
            }
            for candidate in CANDIDATES
        ]
        return Response({"results": found})


class UavTypeAirframe(APIView):
    @extend_schema(
        operation_id="get_airframe_of_uav_type",
        summary="Which simulated airframe flies for a type's UAVs",
        responses=shapes.TypeAirframeSerializer,
    )
    def get(self, request: SignedInRequest, type_id: int) -> Response:
        return _answer(get_object_or_404(types_of_organisation(request.user.organisation), pk=type_id))

    @extend_schema(
        operation_id="choose_airframe_of_uav_type",
        summary="Say which simulated airframe flies for a type's UAVs",
        description="null: the nearest by mass and endurance. Rehearsals of their missions are out of date if another one flies then.",
        request=shapes.TypeAirframeSerializer,
        responses=shapes.TypeAirframeSerializer,
    )
    def put(self, request: SignedInRequest, type_id: int) -> Response:
        uav_type = get_object_or_404(types_of_organisation(request.user.organisation), pk=type_id)
        body = shapes.TypeAirframeSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        try:
            choose_airframe(uav_type=uav_type, airframe=body.validated_data["airframe"], actor=request.user)
        except NoSuchAirframe as error:
            raise invalid("airframe", _("There is no airframe %(code)s.") % {"code": str(error)[:40]}) from error
        return _answer(uav_type)


class RehearsalRuleView(APIView):
    write_roles = ADMINISTRATORS
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="get_rehearsal_rule",
        summary="Whether approval asks for a rehearsal that passed",
        responses=shapes.RehearsalRuleSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        return Response({"requires_green": selectors.requires_green(request.user.organisation_id)})

    @extend_schema(
        operation_id="set_rehearsal_rule",
        summary="Say whether approval asks for a rehearsal that passed",
        description="Off by default. An assessment with warnings counts; one of another plan does not. Administrators alone.",
        request=shapes.RehearsalRuleSerializer,
        responses=shapes.RehearsalRuleSerializer,
    )
    def put(self, request: SignedInRequest) -> Response:
        body = shapes.RehearsalRuleSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        rule = set_rule(organisation=request.user.organisation, actor=request.user, requires=body.validated_data["requires_green"])
        return Response({"requires_green": rule.requires_green})


def _answer(uav_type: UavType) -> Response:
    return Response({"airframe": selectors.chosen_airframe(uav_type), "flown": airframe_of_type(uav_type)})
