"""Demo missions and UAVs: state, creation and removal."""

from django.db import transaction
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework import serializers
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.models import Mission, Uav
from missions.views.problems import refusals
from simulation.services.demo_missions import has_demo_region, open_demo_job, remove_demo_data, want_demo_missions
from workspace.api.errors import ApiProblem
from workspace.api.idempotency import idempotent
from workspace.api.permissions import ADMINISTRATORS
from workspace.api.signed_in import SignedInRequest
from workspace.models import Organisation
from workspace.tasks import send_job_on_commit


class DemoDataSerializer(serializers.Serializer):
    can_be_made = serializers.BooleanField(help_text="the demo region is there, and its missions are not")
    job = serializers.UUIDField(allow_null=True, help_text="that makes the missions now")
    missions = serializers.IntegerField()
    uavs = serializers.IntegerField()


class DemoRemovedSerializer(serializers.Serializer):
    missions = serializers.IntegerField(help_text="deleted, with their records")
    uavs = serializers.IntegerField(help_text="deleted")


class DemoData(APIView):
    write_roles = ADMINISTRATORS

    @extend_schema(operation_id="get_demo_data", summary="What there is of the demo missions and UAVs", responses=DemoDataSerializer)
    def get(self, request: SignedInRequest) -> Response:
        return Response(_found(request.user.organisation))

    @extend_schema(
        operation_id="make_demo_missions",
        summary="Make the demo missions: one flown, one in flight, one planned",
        description="By the planner and by simulated UAVs of the demo region. A job makes them; those that are there are left as they are.",
        request=None,
        responses={202: DemoDataSerializer, 409: OpenApiResponse(description="The demo region was removed.")},
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        if not has_demo_region(request.user.organisation):
            raise ApiProblem(409, "no_demo_region", _("The demo region was removed."))
        with transaction.atomic():
            send_job_on_commit(want_demo_missions(organisation=request.user.organisation, actor=request.user))
        return Response(_found(request.user.organisation), status=202)

    @extend_schema(
        operation_id="remove_demo_data",
        summary="Remove the demo missions with their records, and the demo UAVs",
        description="Simulated flights of demo missions end at once. UAVs that another mission has stay. Assets and zones stay.",
        responses={200: DemoRemovedSerializer, 409: OpenApiResponse(description="A real UAV may fly one of them.")},
    )
    def delete(self, request: SignedInRequest) -> Response:
        with refusals():
            return Response(remove_demo_data(organisation=request.user.organisation, actor=request.user))


def _found(organisation: Organisation) -> dict[str, object]:
    job = open_demo_job(organisation)
    missions = Mission.objects.filter(organisation=organisation, is_demo=True, deleted_at=None).count()
    return {
        "can_be_made": missions == 0 and job is None and has_demo_region(organisation),
        "job": None if job is None else job.pk,
        "missions": missions,
        "uavs": Uav.objects.filter(organisation=organisation, is_demo=True).count(),
    }
