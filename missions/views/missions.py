"""Missions: create, list, open, change, plan, delete, restore."""

from dataclasses import replace
from typing import Any
from uuid import UUID

from django.db import transaction
from django.http import Http404
from django.urls import reverse
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.selectors import ground_revision
from missions import services
from missions.hooks.rehearsals import failed_rehearsals
from missions.models import Mission, MissionState
from missions.selectors import missions
from missions.selectors.mission_list import (
    LAST_CHANGED_FIRST,
    ORDERS,
    MissionFilter,
    counts_by_state,
    mission_rows,
    missions_found,
    order_of,
    surroundings,
)
from missions.selectors.stale_plans import bases_landed_at
from missions.selectors.uav_changes import missions_with_other_uavs
from missions.serializers import inputs, shapes
from missions.serializers.changes import HistoryEntrySerializer, HistoryPageSerializer
from missions.serializers.representations import mission_json, mission_summary
from missions.services import Charging, Departure, MissionChange
from missions.views.plans import PLAN_EXAMPLE, effort_of, is_small, job_answer, planning_job
from missions.views.problems import api_problems
from planning.task import task_from_json
from workspace.api.errors import ApiProblem
from workspace.api.external_data import EXTERNAL_ID, asked_external_id
from workspace.api.idempotency import idempotent
from workspace.api.paging import asked_flag, asked_instant, changed_since, page_of
from workspace.api.preconditions import need_if_match
from workspace.api.schema import CHANGED_SINCE, DAY_OR_TIME, PAGE_PARAMETERS, request_example, several_of
from workspace.api.signed_in import SignedInRequest
from workspace.api.throttling import ScopedRate
from workspace.api.whole_numbers import WholeNumber
from workspace.jobs.services import TooManyJobs
from workspace.models import Job, User

ORDER_NAMES = [*ORDERS, *(f"-{name}" for name in ORDERS)]
UAV = WholeNumber("uav", "id of a UAV that the mission uses")
FILTER_PARAMETERS = [
    OpenApiParameter("text", str, description="part of the name, of the author's name or of a target's name"),
    OpenApiParameter("state", several_of(MissionState.values), description=f"one or several with commas: {', '.join(MissionState.values)}"),
    OpenApiParameter("author", str, description="user name"),
    UAV.documented,
    OpenApiParameter("stale", bool, description="whether the ground or a UAV has changed since the mission was planned"),
    OpenApiParameter("changed_from", DAY_OR_TIME, description="date or time with offset, ISO 8601"),
    OpenApiParameter("changed_before", DAY_OR_TIME, description="date or time with offset, ISO 8601"),
    EXTERNAL_ID,
    OpenApiParameter("target_external_id", str, description="the external id of one of its targets"),
    OpenApiParameter("deleted", bool, description="true: the deleted ones"),
    OpenApiParameter("order", str, enum=ORDER_NAMES, description="the column to sort by, with - for descending; -changed without one"),
]
IF_MATCH = OpenApiParameter(
    "If-Match", str, OpenApiParameter.HEADER, required=True,
    description="the ETag of the mission as last seen, or * for whatever is there; 412 if it has changed",
)  # fmt: skip
# Requests that stop UAVs, or take missions from them, never fail for a missing header.
IF_MATCH_OPTIONAL = OpenApiParameter(
    "If-Match", str, OpenApiParameter.HEADER, description="the ETag of the mission as last seen: 412 if it has changed; without it any"
)
IF_NONE_MATCH = OpenApiParameter(
    "If-None-Match", str, OpenApiParameter.HEADER, description="the ETag of the mission as last seen; 304 while it is the same"
)
CHANGED = {
    409: OpenApiResponse(description="The mission cannot be changed, or somebody else was faster."),
    412: OpenApiResponse(description="The mission has changed since."),
    428: OpenApiResponse(description="If-Match is missing."),
}
PLANNED_LATER = {202: OpenApiResponse(shapes.JobLinkSerializer, description="Stored; a job plans it, see Location.")}


def asked_filter(request: Request) -> MissionFilter:
    """Return the filter of a request. Raises ApiProblem 400 for invalid filters."""
    ask = request.query_params
    states = tuple(state for state in ask.get("state", "").split(",") if state)
    if unknown := [state for state in states if state not in MissionState.values]:
        raise _refusal("state", _("There is no state %(state)s.") % {"state": unknown[0][:20]})
    return MissionFilter(
        text=ask.get("text", "").strip()[:100].replace("\0", ""),
        states=states,
        author=ask.get("author", "").strip()[:150].replace("\0", ""),
        uav=UAV.asked(request),
        is_stale=asked_flag(request, "stale"),
        changed_from=asked_instant(request, "changed_from"),
        changed_before=asked_instant(request, "changed_before"),
        external_id=asked_external_id(request),
        target_external_id=asked_external_id(request, "target_external_id"),
        is_deleted=asked_flag(request, "deleted") or False,
    )


def asked_order(request: Request) -> tuple[str, str]:
    try:
        return order_of(request.query_params.get("order") or LAST_CHANGED_FIRST)
    except KeyError as error:
        raise _refusal("order", _("Missions are sorted by %(names)s.") % {"names": ", ".join(ORDERS)}) from error


def _refusal(name: str, message: str) -> Any:
    return ApiProblem(400, "invalid", f"{name}: {message}", details={name: [message]})


def mission_or_404(user: User, mission_id: UUID, *, deleted: bool = False) -> Mission:
    try:
        return missions.mission_of_organisation(user.organisation, mission_id, deleted=deleted)
    except Mission.DoesNotExist as error:
        raise Http404 from error


def answer_mission(user: User, mission_id: UUID, *, status: int = 200) -> Response:
    mission = mission_or_404(user, mission_id)
    # A browser that stored the response would send the ETag by itself and show old map data: only pages may do so.
    headers = {"ETag": f'"{mission.revision}"', "Cache-Control": "no-store"}
    if status == 201:
        headers["Location"] = reverse("api-mission", args=[mission.pk])
    return Response(mission_json(mission), status=status, headers=headers)


def expected_revision(request: Request) -> int | None:
    """Return the revision that If-Match names; None for any (*). Raises ApiProblem 428 without the header."""
    need_if_match(request)
    return stated_revision(request)


def stated_revision(request: Request) -> int | None:
    """Return the revision that If-Match names; None without the header or for any (*)."""
    text = request.headers.get("If-Match", "*").strip().removeprefix("W/").strip('"')
    if text == "*":
        return None
    if not (text.isascii() and text.isdigit() and len(text) < 10):
        raise ApiProblem(412, "mission_changed", "If-Match is not a mission's ETag.")
    return int(text)


def _change(values: dict[str, Any]) -> MissionChange:
    """Return the change. A departure or charging of null is a change, too."""
    if "departs_at" in values:
        values["departure"] = Departure(values.pop("departs_at"))
    if "charging_w" in values:
        values["charging"] = Charging(values.pop("charging_w"))
    return MissionChange(**values)


def _plan_and_answer(user: User, mission: Mission, *, revision: int, status: int = 200, plan_of: UUID | None = None) -> Response:
    """Plan the stored mission: with the plan of a job for the same request, else now, or in a job if it is large."""
    made = Job.objects.filter(organisation=user.organisation, pk=plan_of).first() if plan_of else None
    if made and services.take_plan(mission=mission, actor=user, revision=revision, job=made):
        return answer_mission(user, mission.pk, status=status)
    tasks = list(map(task_from_json, mission.targets.values_list("task", flat=True)))
    if is_small(effort_of(tasks)):
        services.plan_mission(mission=mission, actor=user, expected_revision=revision)
        return answer_mission(user, mission.pk, status=status)
    services.plannable_request(mission=mission)
    job = planning_job(user, missions.PLAN_MISSION, {"mission": str(mission.pk), "revision": revision}, len(tasks))
    return job_answer(job, mission=str(mission.pk))


class _PlansWhenAsked(APIView):
    """Base view that throttles only requests that plan."""

    throttle_scope = "plans"

    def get_throttles(self) -> list[Any]:
        return [ScopedRate()] if self.request.method in {"POST", "PATCH"} else []


class MissionList(_PlansWhenAsked):
    @extend_schema(
        operation_id="list_missions",
        summary="Missions, the last changed first",
        parameters=[*FILTER_PARAMETERS, CHANGED_SINCE, *PAGE_PARAMETERS],
        responses=shapes.MissionPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        organisation, asked = request.user.organisation, asked_filter(request)
        rows = mission_rows(changed_since(request, missions_found(organisation, asked)))
        page = page_of(request, rows, order=asked_order(request), default_limit=50, max_limit=200)
        in_any_state = changed_since(request, missions_found(organisation, replace(asked, states=(), is_deleted=None)))
        there, deleted = counts_by_state(in_any_state)
        by_state = deleted if asked.is_deleted else there
        drawings, ground = surroundings(page.rows), ground_revision()
        bases, others = bases_landed_at(page.rows, organisation.pk), missions_with_other_uavs(page.rows)
        failed = failed_rehearsals(page.rows)
        return Response({
            "results": [
                mission_summary(
                    mission,
                    ground,
                    drawings[mission.pk],
                    bases,
                    has_other_uavs=mission.pk in others,
                    has_failed_rehearsal=mission.pk in failed,
                )
                for mission in page.rows
            ],
            "next": page.next,
            "total": sum(number for state, number in by_state.items() if not asked.states or state in asked.states),
            "by_state": by_state,
            "deleted_count": sum(deleted.values()),
        })  # fmt: skip

    @extend_schema(
        operation_id="create_mission",
        summary="Create a mission, and plan it if asked",
        request=inputs.MissionInputSerializer,
        responses={201: shapes.MissionSerializer, **PLANNED_LATER},
        examples=[request_example({"name": "Line inspection", **PLAN_EXAMPLE, "plan": True})],
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        user = request.user
        serializer = inputs.MissionInputSerializer(data=request.data, context={"organisation": user.organisation})
        serializer.is_valid(raise_exception=True)
        values = serializer.validated_data
        with api_problems(), transaction.atomic():  # a mission that cannot be planned as requested is rolled back
            mission = services.create_mission(
                organisation=user.organisation,
                author=user,
                name=values["name"],
                request=inputs.plan_request(values),
                external_id=values.get("external_id", ""),
                attributes=values.get("attributes"),
            )
            if values["plan"]:
                return _plan_and_answer(user, mission, revision=mission.revision, status=201, plan_of=values.get("plan_of"))
        return answer_mission(user, mission.pk, status=201)


class MissionDetail(_PlansWhenAsked):
    @extend_schema(
        operation_id="get_mission",
        summary="A mission with its plan",
        parameters=[IF_NONE_MATCH],
        responses={200: shapes.MissionSerializer, 304: OpenApiResponse(description="It is as it was.")},
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        known = request.headers.get("If-None-Match")
        if known is not None:
            revision = missions.revision_of_mission(request.user.organisation_id, mission_id)
            if revision is not None and f'"{revision}"' in [tag.strip().removeprefix("W/") for tag in known.split(",")]:
                return Response(status=304, headers={"ETag": f'"{revision}"'})
        return answer_mission(request.user, mission_id)

    @extend_schema(
        operation_id="change_mission",
        summary="Change a mission",
        description="New targets, UAVs or options drop the plan; `plan: true` makes a new one. `lost_link` is checked on it.",
        parameters=[IF_MATCH],
        request=inputs.MissionPatchSerializer,
        responses={200: shapes.MissionSerializer, **PLANNED_LATER, **CHANGED},
    )
    def patch(self, request: SignedInRequest, mission_id: UUID) -> Response:
        user = request.user
        expected = expected_revision(request)
        mission = mission_or_404(user, mission_id)
        serializer = inputs.MissionPatchSerializer(data=request.data, context={"organisation": user.organisation})
        serializer.is_valid(raise_exception=True)
        values = dict(serializer.validated_data)
        wants_plan, plan_of = values.pop("plan"), values.pop("plan_of", None)
        with api_problems(has_precondition=expected is not None), transaction.atomic():
            if values:
                mission = services.change_mission(mission=mission, actor=user, change=_change(values), expected_revision=expected)
                expected = mission.revision
            if wants_plan:
                revision = mission.revision if expected is None else expected
                return _plan_and_answer(user, mission, revision=revision, plan_of=plan_of)
        return answer_mission(user, mission_id)

    @extend_schema(
        operation_id="delete_mission",
        summary="Delete a mission; it can be brought back",
        parameters=[IF_MATCH],
        responses={204: None, **CHANGED},
    )
    def delete(self, request: SignedInRequest, mission_id: UUID) -> Response:
        expected = expected_revision(request)
        mission = mission_or_404(request.user, mission_id)
        with api_problems(has_precondition=expected is not None):
            services.delete_mission(mission=mission, actor=request.user, expected_revision=expected)
        return Response(status=204)


class MissionPlan(_PlansWhenAsked):
    @extend_schema(
        operation_id="plan_mission",
        summary="Plan a mission, or plan it again",
        parameters=[IF_MATCH],
        request=None,
        responses={200: shapes.MissionSerializer, **PLANNED_LATER, **CHANGED},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        expected = expected_revision(request)
        mission = mission_or_404(request.user, mission_id)
        with api_problems(has_precondition=expected is not None):
            return _plan_and_answer(request.user, mission, revision=mission.revision if expected is None else expected)


class MissionProof(_PlansWhenAsked):
    @extend_schema(
        operation_id="prove_mission_plan",
        summary="Look for a better plan of a mission in the background, and prove how good its plan is",
        description="For plans of up to 40 targets that are not proven. The job takes about a minute, yields to all other work, and can be "
        "stopped. Then the quality of the mission's plan holds the better bound, and the job's result is the best plan found: if that is "
        "better, PATCH the mission with this job as `plan_of`. Asked again for the same plan, the answer is the same job.",
        request=None,
        responses={
            202: OpenApiResponse(shapes.JobLinkSerializer, description="A job looks for it; see Location."),
            409: OpenApiResponse(description="`nothing_to_prove`, or the mission cannot be changed."),
        },
    )
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        with api_problems():
            try:
                job = services.begin_proof(mission=mission)
            except TooManyJobs as error:
                raise ApiProblem(429, "too_many_jobs", _("Enough plans wait to be proven. Ask again later."), retry_after_s=60) from error
        return job_answer(job, mission=str(mission.pk))


class MissionRestore(APIView):
    @extend_schema(
        operation_id="restore_mission", summary="Bring a deleted mission back", request=None, responses={200: shapes.MissionSerializer}
    )
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id, deleted=True)
        services.restore_mission(mission=mission, actor=request.user)
        return answer_mission(request.user, mission_id)


class MissionHistory(APIView):
    @extend_schema(
        operation_id="list_mission_history",
        summary="Who changed what in a mission, the newest first",
        parameters=PAGE_PARAMETERS,
        responses=HistoryPageSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        page = page_of(request, missions.history_of_mission(mission_or_404(request.user, mission_id)), order=("-recorded_at", "-pk"))
        return Response({"results": HistoryEntrySerializer(page.rows, many=True).data, "next": page.next})
