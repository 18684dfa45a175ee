"""Exports that a job writes: started, stopped, and their files."""

from typing import Any
from uuid import UUID

from django.db import transaction
from django.http import Http404, HttpResponseBase, StreamingHttpResponse
from django.urls import reverse
from django.utils.translation import gettext as _
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import Upload
from inspection.selectors.register.assets import AssetFilter
from inspection.selectors.register.zones import ZoneFilter
from inspection.services.exports import EXPORT_TASK, ask_for_export, forget_export
from inspection.views.export_files import MEDIA_TYPES
from workspace.api.errors import ApiProblem
from workspace.api.renderers import OneAnswer
from workspace.api.signed_in import SignedInRequest
from workspace.jobs.serializers import JobSerializer
from workspace.jobs.services import TooManyJobs
from workspace.models import Job, Role, User
from workspace.tasks import send_job_on_commit

EXPORT_JOB = (
    "The answer is the job, its address in `Location`. Once it is done, `GET /api/v1/exports/{job_id}` returns the file for a day, to its "
    "user alone; the last 3 files of a user are kept. `DELETE` stops the job."
)
JOB_ANSWERS: dict[Any, Any] = {
    202: JobSerializer,
    409: OpenApiResponse(description="Nothing or too much to export."),
    429: OpenApiResponse(description="Enough jobs of this user wait or run."),
}


def export_job(register: str, wanted: AssetFilter | ZoneFilter, rows: int, user: User) -> Response:
    """Start the job and answer with it. Raises ApiProblem 429."""
    try:
        with transaction.atomic():
            job = ask_for_export(register=register, wanted=wanted, rows=rows, actor=user)
            send_job_on_commit(job)
    except TooManyJobs as error:
        raise ApiProblem(429, "too_many_jobs", str(error)) from error
    return Response(JobSerializer(job).data, status=202, headers={"Location": reverse("api-job", args=[job.pk])})


def _own(user: User, job_id: UUID) -> Job:
    job = Job.objects.filter(pk=job_id, organisation=user.organisation_id, created_by=user, task=EXPORT_TASK).first()
    if job is None:
        raise Http404
    return job


class ExportDetail(APIView):
    write_roles = frozenset(Role)
    content_negotiation_class = OneAnswer

    @extend_schema(
        operation_id="get_export",
        summary="The file that an export's job has written",
        responses={
            (200, MEDIA_TYPES["gpkg"]): OpenApiTypes.BINARY,
            404: OpenApiResponse(description="No such export of one's own, or its file is no longer kept."),
            409: OpenApiResponse(description="Not written yet."),
        },
    )
    def get(self, request: SignedInRequest, job_id: UUID) -> HttpResponseBase:
        job = _own(request.user, job_id)
        if job.is_open:
            raise ApiProblem(409, "not_ready", _("The file is not written yet."))
        upload = Upload.objects.filter(pk=job.pk).first()
        if upload is None:
            raise Http404
        parts = upload.parts.order_by("first_byte").values_list("content", flat=True).iterator(chunk_size=1)
        response = StreamingHttpResponse((bytes(part) for part in parts), content_type=MEDIA_TYPES["gpkg"])
        response["Content-Length"] = str(upload.size_bytes)
        response["Content-Disposition"] = f'attachment; filename="{upload.file_name}"'
        response["Cache-Control"] = "private, no-cache"
        return response

    @extend_schema(operation_id="delete_export", summary="Stop an export, or delete its file", responses={204: None})
    def delete(self, request: SignedInRequest, job_id: UUID) -> Response:
        forget_export(job=_own(request.user, job_id))
        return Response(status=204)
