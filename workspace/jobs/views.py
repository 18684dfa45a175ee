"""API endpoints of jobs, and requests that wait for the job that they started: `Prefer: wait=N` (RFC 7240)."""

import re
import threading
import time
from uuid import UUID

from django.conf import settings
from django.http import Http404
from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework.request import Request
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


POLL_INTERVAL_S = 0.1
WAITING_AT_ONCE = 2  # per process: the other threads keep responding

_places = threading.BoundedSemaphore(WAITING_AT_ONCE)
_WAIT = re.compile(r"""(?:^|[,;])\s*wait\s*=\s*"?(\d{1,9})"?\s*(?=$|[,;])""", re.IGNORECASE)


def preferred_wait_s(request: Request) -> int | None:
    """Return the whole seconds that the request would wait, within the limit of the settings; None without the preference."""
    found = _WAIT.search(request.META.get("HTTP_PREFER", ""))
    return min(int(found[1]), int(settings.MAX_WAIT_S)) if found else None


class NoRoomToWait(Exception):
    """Raised when enough requests of this process wait already; this one gets its response at once."""


def wait_for_job(job_id: UUID, wait_s: float) -> Job | None:
    """Return the job as soon as it has ended; None when it takes longer. Raises NoRoomToWait."""
    if not _places.acquire(blocking=False):
        raise NoRoomToWait
    try:
        until_s = time.monotonic() + wait_s
        while True:
            if not Job.objects.filter(pk=job_id, state__in=(JobState.QUEUED, JobState.RUNNING)).exists():
                return Job.objects.filter(pk=job_id).first()
            if time.monotonic() >= until_s:
                return None
            time.sleep(POLL_INTERVAL_S)
    finally:
        _places.release()
