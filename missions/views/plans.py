"""Plans that are answered, not stored."""

from django.conf import settings
from django.urls import reverse
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from missions import services
from missions.serializers.inputs import PlanInputSerializer
from missions.serializers.shapes import JobLinkSerializer, PlanSerializer
from missions.views.problems import api_problems
from workspace.idempotency import idempotent
from workspace.models import Job
from workspace.services import create_job
from workspace.tasks import send_job_on_commit
from workspace.throttling import ScopedRate


class PlanList(APIView):
    throttle_classes = [ScopedRate]
    throttle_scope = "plans"

    @extend_schema(
        operation_id="make_plan",
        summary="Plan routes for several UAVs, without storing them",
        description="Up to 12 targets are planned at once; more become a job, whose result is the plan.",
        request=PlanInputSerializer,
        responses={200: PlanSerializer, 202: OpenApiResponse(JobLinkSerializer, description="A job plans it; see Location.")},
    )
    @idempotent
    def post(self, request: Request) -> Response:
        organisation = request.user.organisation
        serializer = PlanInputSerializer(data=request.data, context={"organisation": organisation})
        serializer.is_valid(raise_exception=True)
        asked = serializer.to_request()
        with api_problems():
            if is_small(len(asked.targets)):
                return Response(services.make_plan(request=asked))
            services.places_of(asked.targets)  # says at once what a worker would find wrong later
            job = create_job(
                organisation=organisation,
                created_by=request.user,
                task="missions.tasks.solve_plan",
                parameters={"request": services.request_to_json(asked)},
                message=planning_message(len(asked.targets)),
            )
        send_job_on_commit(job)
        return job_answer(job)


def is_small(targets: int) -> bool:
    return targets <= settings.ROUTING_RULES.small_plan_targets


def planning_message(targets: int) -> str:
    return f"Planning {targets} targets"


def job_answer(job: Job, **more: str) -> Response:
    return Response({"job": str(job.pk), **more}, status=202, headers={"Location": reverse("api-job", args=[job.pk])})
