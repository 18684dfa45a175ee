"""API endpoints of jobs."""

from uuid import UUID

from django.http import Http404
from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from workspace import selectors
from workspace.api.paging import asked_choice, asked_flag, page_of
from workspace.api.permissions import CURATORS, PLANNERS
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.jobs import services
from workspace.jobs.serializers import JobPageSerializer, JobSerializer, ListedJobSerializer
from workspace.models import OPEN_STATES, Job, JobState, User


def _job(user: User, job_id: UUID) -> Job:
    try:
        return selectors.job_of_organisation(user.organisation, job_id)
    except Job.DoesNotExist as error:
        raise Http404 from error


class JobList(APIView):
    @extend_schema(
        operation_id="list_jobs",
        summary="Jobs of one's organisation, newest first",
        parameters=[
            OpenApiParameter("state", str, enum=JobState.values),
            OpenApiParameter("open", bool, description="true: only those that wait or run"),
            OpenApiParameter("mine", bool, description="true: only those that one has started oneself"),
            *PAGE_PARAMETERS,
        ],
        responses=JobPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        jobs = selectors.jobs_of_organisation(request.user.organisation)
        if state := asked_choice(request, "state", JobState.values):
            jobs = jobs.filter(state=state)
        if asked_flag(request, "open"):
            jobs = jobs.filter(state__in=OPEN_STATES)
        if asked_flag(request, "mine"):
            jobs = jobs.filter(created_by=request.user)
        page = page_of(request, jobs.defer("best", "result", "parameters"), order=("-created_at", "-pk"))
        return Response({"results": ListedJobSerializer(page.rows, many=True).data, "next": page.next})


class JobDetail(APIView):
    @extend_schema(operation_id="get_job", summary="One job: how far it is, and its result", responses=JobSerializer)
    def get(self, request: SignedInRequest, job_id: UUID) -> Response:
        return Response(JobSerializer(_job(request.user, job_id)).data)


class JobCancel(APIView):
    write_roles = PLANNERS | CURATORS

    @extend_schema(
        operation_id="cancel_job",
        summary="Ask a job to stop",
        description="A queued job is cancelled at once, a running one at its next step; a finished one stays as it is.",
        request=None,
        responses=JobSerializer,
    )
    def post(self, request: SignedInRequest, job_id: UUID) -> Response:
        job = services.cancel_job(job=_job(request.user, job_id))
        return Response(JobSerializer(job).data)
