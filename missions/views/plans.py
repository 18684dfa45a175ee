"""Plans that are returned without being stored, of routes and of photos, and the catalogue of cameras."""

from collections.abc import Iterable
from typing import Any
from uuid import UUID

from django.conf import settings
from django.http import Http404
from django.urls import reverse
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import Asset
from missions import services
from missions.reason_texts import plan_with_texts
from missions.selectors.inspection_sites import UnfitBridge
from missions.selectors.photo_flights import NotATower
from missions.serializers.inputs import PlanInputSerializer
from missions.serializers.reachability import ReachabilityInputSerializer, ReachabilitySerializer
from missions.serializers.shapes import JobLinkSerializer, PlanSerializer
from missions.serializers.view_plans import (
    CameraCatalogueSerializer,
    ViewPlanInputSerializer,
    ViewPlanSerializer,
    catalogue_json,
    views_request,
)
from missions.services.planning.reachability import reachability
from missions.services.view_plans import plan_views
from missions.views.problems import api_problems
from operation.reasons import Reason
from planning.task import Task
from planning.views.catalogue import catalogue
from planning.views.detail_views import TooManyPhotos
from planning.views.view_flight import NoWay
from workspace.api.errors import ApiProblem
from workspace.api.idempotency import idempotent
from workspace.api.renderers import FastJSONRenderer
from workspace.api.schema import request_example
from workspace.api.signed_in import SignedInRequest
from workspace.api.throttling import ScopedRate
from workspace.jobs.services import TooManyJobs, create_job_within, refuse_jobs_beyond
from workspace.jobs.views import NoRoomToWait, preferred_wait_s, wait_for_job
from workspace.models import Job, JobState, Role, User
from workspace.reason_texts import reason_text, with_message
from workspace.tasks import send_job_on_commit

PHOTOS_EFFORT = 6  # planning the photos of a target takes as long as so many targets
PLAN_EXAMPLE = {
    "uavs": [{"name": "Kestrel 1", "position": [9.52, 47.14]}],
    "targets": [{"position": [9.53, 47.15]}, {"position": [9.55, 47.15]}],
}
SOLVE_PLAN = "missions.tasks.solve_plan"
JOBS_RETRY_AFTER_S = 10
STATUS_OF_FAILURE = {
    "invalid": 400,
    "nothing_to_plan": 400,
    "no_graph": 503,
    "graph_outdated": 503,
    "took_too_long": 503,
    "worker_lost": 503,
}
PREFER = OpenApiParameter(
    "Prefer",
    str,
    OpenApiParameter.HEADER,
    description="`wait=N`: for a large plan, wait up to N seconds for it (RFC 7240). 200 with the plan if it is done by then, else 202.",
)


class ReachableAssets(APIView):
    write_roles = frozenset(Role)
    renderer_classes = [FastJSONRenderer]
    throttle_classes = [ScopedRate]
    throttle_scope = "plans"

    @extend_schema(
        operation_id="reachable_assets",
        summary="Which assets the UAVs can inspect, one flight for each, and why the others they cannot",
        description="Judged as a plan with the asset as its only target would be, on the zones that can be in force during the flight.",
        request=ReachabilityInputSerializer,
        responses=ReachabilitySerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        values = ReachabilityInputSerializer.read(request.data, organisation=request.user.organisation)
        with api_problems():
            return Response(reachability(request=values["request"], starts=values["starts"], box=values.get("box")))


class PlanList(APIView):
    renderer_classes = [FastJSONRenderer]
    throttle_classes = [ScopedRate]
    throttle_scope = "plans"

    @extend_schema(
        operation_id="make_plan",
        summary="Plan routes for several UAVs, without storing them",
        description="Up to 12 targets are planned at once; more become a job, whose result is the plan.",
        parameters=[PREFER],
        request=PlanInputSerializer,
        responses={200: PlanSerializer, 202: OpenApiResponse(JobLinkSerializer, description="A job plans it; see Location.")},
        examples=[request_example(PLAN_EXAMPLE)],
    )
    def post(self, request: Request) -> Response:
        response = self._answer(request)
        wait_s = preferred_wait_s(request)
        if response.status_code == 202 and wait_s is not None:  # after the commit, or no worker would see the job
            return _awaited(response, wait_s)
        return response

    @idempotent
    def _answer(self, request: SignedInRequest) -> Response:
        if not is_small(_target_count(request.data)):
            refuse_too_many_jobs(request.user)
        asked = PlanInputSerializer.read_request(request.data, request.user.organisation)
        with api_problems():
            if is_small(effort_of(target.task for target in asked.targets)):
                return Response(plan_with_texts(services.make_plan(request=asked, as_text=True)))
            services.resolved_targets(asked.targets)  # reports at once what a worker would reject later
        return job_answer(planning_job(request.user, SOLVE_PLAN, {"request": services.request_to_json(asked)}, len(asked.targets)))


class CameraCatalogue(APIView):
    @extend_schema(
        operation_id="list_catalogue_cameras",
        summary="Common inspection cameras, with the source of each figure",
        responses=CameraCatalogueSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        return Response({"results": [catalogue_json(own) for own in catalogue().values()]})


class ViewPlans(APIView):
    write_roles = frozenset(Role)
    renderer_classes = [FastJSONRenderer]
    throttle_classes = [ScopedRate]
    throttle_scope = "view-plans"

    @extend_schema(
        operation_id="plan_views",
        summary="Plan photos of a tower, its wires or a bridge at a ground sample distance, clear of wires and structures",
        description="The fewest photos found that show what can be shown of the tower or bridge, or photos of a tower's wires with an "
        "overlap of 30 %; the flight through them, and the coverage of each component. Assets are modelled from their tags: of a bridge "
        "the height of its deck is estimated, and piers are assumed every 30 m. Wires count with their swing. The UAV never flies under "
        "a bridge. Nothing is stored.",
        request=ViewPlanInputSerializer,
        responses=ViewPlanSerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        values = ViewPlanInputSerializer.read(request.data)
        asset = Asset.objects.filter(pk=values["asset"], vanished_at=None).first()
        if asset is None:
            raise Http404
        try:
            plan = plan_views(asset=asset, views=views_request(values))
        except NotATower as error:
            message = reason_text(Reason("photos_not_a_tower"))
            raise ApiProblem(400, "not_a_tower", message, details={"asset": [message]}) from error
        except UnfitBridge as error:
            message = reason_text(Reason(f"photos_{error.code}"))
            raise ApiProblem(409, error.code, message, details={"asset": [message]}) from error
        except TooManyPhotos as error:
            message = _("It would take too many photos. Choose a coarser ground sample distance, or a camera with more pixels.")
            raise ApiProblem(400, "too_many_photos", message, details={"gsd_mm": [message]}) from error
        except NoWay as error:
            message = _("No flight keeps clear of wires, structures, ground and the greatest height here.")
            raise ApiProblem(409, "no_way", message) from error
        return Response(plan)


def is_small(targets: int) -> bool:
    return targets <= settings.ROUTING_RULES.small_plan_targets


def effort_of(tasks: Iterable[Task | None]) -> int:
    """Return as how many targets these count, one task each, in the time that a plan takes."""
    return sum(1 if task is None or task.views is None else PHOTOS_EFFORT for task in tasks)


def _target_count(body: Any) -> int:
    """Return the number of targets of an unvalidated body."""
    targets = body.get("targets") if isinstance(body, dict) else None
    return len(targets) if isinstance(targets, list) else 0


def refuse_too_many_jobs(user: User) -> None:
    """Raise ApiProblem 429, before any work, for a user with the maximum number of large plans waiting and running."""
    try:
        refuse_jobs_beyond(settings.MAX_OPEN_PLANS, user=user, task=SOLVE_PLAN)
    except TooManyJobs as error:
        raise _too_many(error) from error


def planning_job(user: User, task: str, parameters: dict[str, Any], targets: int) -> Job:
    """Create a job that plans this many targets; it is sent to a worker once this transaction commits."""
    try:
        job = create_job_within(
            settings.MAX_OPEN_PLANS,
            organisation=user.organisation,
            created_by=user,
            task=task,
            parameters=parameters,
            message=Reason("planning_targets", {"count": targets}),
        )
    except TooManyJobs as error:  # two concurrent requests
        raise _too_many(error) from error
    send_job_on_commit(job)
    return job


def _too_many(error: TooManyJobs) -> ApiProblem:
    return ApiProblem(429, "too_many_jobs", str(error), retry_after_s=JOBS_RETRY_AFTER_S)


def job_answer(job: Job, **more: str) -> Response:
    return Response({"job": str(job.pk), **more}, status=202, headers={"Location": reverse("api-job", args=[job.pk])})


def _awaited(response: Response, wait_s: int) -> Response:
    """Return the plan itself if its job ends in time; else the given response with the job's URL."""
    try:
        job = wait_for_job(UUID(response.data["job"]), wait_s)
    except NoRoomToWait:
        return response
    if job is not None and job.state == JobState.FAILED:
        error = job.error or {}
        code, message = str(error.get("code", "")), with_message(error)["message"]
        status = STATUS_OF_FAILURE.get(code, 500)
        raise ApiProblem(status, code, message, retry_after_s=JOBS_RETRY_AFTER_S if status == 503 else None)
    headers = {name: response[name] for name in ("Location", "Idempotency-Replayed") if name in response}
    if job is not None and job.state == JobState.DONE:
        return Response(job.result and plan_with_texts(job.result), headers=headers | {"Preference-Applied": f"wait={wait_s}"})
    response["Preference-Applied"] = f"wait={wait_s}"
    return response
