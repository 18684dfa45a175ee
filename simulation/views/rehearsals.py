"""Rehearsals of missions: start, list, detail, track and cancel."""

from collections.abc import Sequence
from typing import Any
from uuid import UUID

from django.db import transaction
from django.http import Http404
from django.urls import reverse
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.selectors import ground_revision
from inspection.views.parameters import invalid
from missions.models import Mission
from missions.services.commands.refused import Refused
from missions.views.missions import mission_or_404
from missions.views.problems import refusals
from planning.energy.conditions import Conditions, InvalidConditions, conditions_from_json
from simulation import selectors
from simulation.models import Rehearsal
from simulation.rehearsing.weather_scenario import Named, WeatherScenario, named_scenario, own_scenario
from simulation.serializers import shapes
from simulation.serializers.representations import planned_points, rehearsal_detail_json, rehearsal_json, track_json
from simulation.services.plan_to_fly import plan_to_fly
from simulation.services.rehearsals import cancel_rehearsal, start_rehearsal
from workspace.api.errors import ApiProblem
from workspace.api.idempotency import idempotent
from workspace.api.paging import page_of
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.api.whole_numbers import WholeNumber
from workspace.jobs.services import TooManyJobs
from workspace.models import User
from workspace.tasks import send_job_on_commit


def scenarios_of(asked: Sequence[Any], planned: Conditions) -> list[WeatherScenario]:
    """Return the scenarios of names and own values, given the planned conditions. Raises ApiProblem."""
    return [scenario_of(entry, planned, f"conditions.{number}") for number, entry in enumerate(asked)]


def scenario_of(entry: Any, planned: Conditions, place: str = "conditions") -> WeatherScenario:
    """Return one scenario. Raises ApiProblem with `place` as the place of the fault."""
    try:
        return named_scenario(Named(entry), planned) if isinstance(entry, str) else own_scenario(entry, planned)
    except InvalidConditions as error:
        raise invalid(f"{place}.{error.place}", f"{error.place} {error.message}.") from error
    except ValueError as error:
        names = ", ".join(str(code) for code in Named if code is not Named.OWN)
        raise invalid(place, f"{entry!r} is none of {names}.") from error


NEWEST_FIRST = ("-created_at", "-pk")
USUAL = (Named.AS_PLANNED,)
RETRY_AFTER_S = 10
REFUSED = {
    409: OpenApiResponse(description="There is no plan to fly: `details.reasons` has each reason."),
    429: OpenApiResponse(description="Too many of your rehearsals are waiting or running."),
}

RUN = WholeNumber("run", "which of its conditions, from 0; 0 by default", minimum=0, maximum=999)


class MissionRehearsals(APIView):
    @extend_schema(
        operation_id="list_rehearsals",
        summary="Rehearsals of a mission in simulation, the newest first",
        description="`is_outdated`: what was flown is not the mission's present plan, and says nothing about it.",
        parameters=PAGE_PARAMETERS,
        responses=shapes.RehearsalPageSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        page = page_of(
            request, selectors.rehearsals_of_mission(request.user.organisation, mission_id), order=NEWEST_FIRST, default_limit=20
        )
        known = _known(mission)
        return Response({"results": [rehearsal_json(row, **known) for row in page.rows], "next": page.next})

    @extend_schema(
        operation_id="start_rehearsal",
        summary="Fly a mission in simulation",
        description=(
            "Every route of the present plan is flown by a simulated UAV from the very items that a UAV would be given, all of them "
            "together in time, once for each of the conditions. A job flies them; its state, and afterwards the assessment: GET the "
            "address in Location. What was flown alike within a day (the same plan, air, seed, limits and ground) is taken over, which the "
            "run tells as `is_reused`; `afresh` flies it again."
        ),
        request=shapes.RehearsalInputSerializer,
        responses={202: shapes.RehearsalSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        body = shapes.RehearsalInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        values = body.validated_data
        scenarios = scenarios_of(values.get("conditions") or list(USUAL), conditions_from_json(mission.conditions or None))
        try:
            with refusals(), transaction.atomic():
                rehearsal = start_rehearsal(
                    mission=mission, actor=request.user, scenarios=scenarios, seed=values["seed"], afresh=values["afresh"]
                )
                send_job_on_commit(rehearsal.job)
        except TooManyJobs as error:
            raise ApiProblem(429, "too_many_jobs", str(error), retry_after_s=RETRY_AFTER_S) from error
        address = reverse("api-rehearsal", args=[mission.pk, rehearsal.pk])
        shown = rehearsal_json(rehearsal_or_404(request.user, mission_id, rehearsal.pk), **_known(mission))
        return Response(shown, status=202, headers={"Location": address})


class RehearsalDetail(APIView):
    @extend_schema(
        operation_id="get_rehearsal",
        summary="A rehearsal with its assessment by route and by target",
        description="Levels: pass, warnings, fail. Each reason stands in words; the limits with their sources stand beside the figures.",
        responses=shapes.RehearsalDetailSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID, rehearsal_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        return Response(rehearsal_detail_json(rehearsal_or_404(request.user, mission_id, rehearsal_id), mission, **_known(mission)))


class RehearsalTrackOfRun(APIView):
    @extend_schema(
        operation_id="get_rehearsal_track",
        summary="The lines that a rehearsal flew, beside the planned ones",
        description="A row a second. Heights above take-off are those of each flight.",
        parameters=[RUN.documented],
        responses=shapes.RehearsalTrackSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID, rehearsal_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        rehearsal = rehearsal_or_404(request.user, mission_id, rehearsal_id)
        run = RUN.asked(request) or 0
        if run not in {row.sequence for row in rehearsal.runs.all()}:
            raise Http404
        tracks = {track.uav: track for track in selectors.tracks_of_run(rehearsal, run)}
        is_present = _known(mission)["content_sha256"] == rehearsal.content_sha256
        return Response(track_json(run, tracks, rehearsal, planned_points(mission) if is_present else {}))


class RehearsalCancel(APIView):
    @extend_schema(
        operation_id="cancel_rehearsal",
        summary="Stop a rehearsal",
        description="What has been flown until then is kept; without all of its conditions it has no assessment.",
        request=None,
        responses=shapes.RehearsalSerializer,
    )
    def post(self, request: SignedInRequest, mission_id: UUID, rehearsal_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        cancel_rehearsal(rehearsal=rehearsal_or_404(request.user, mission_id, rehearsal_id), actor=request.user)
        return Response(rehearsal_json(rehearsal_or_404(request.user, mission_id, rehearsal_id), **_known(mission)))


def rehearsal_or_404(user: User, mission_id: UUID, rehearsal_id: UUID) -> Rehearsal:
    try:
        return selectors.rehearsal_of_mission(user.organisation, mission_id, rehearsal_id)
    except Rehearsal.DoesNotExist as error:
        raise Http404 from error


def _known(mission: Mission) -> dict[str, Any]:
    """Return what a rehearsal is compared with: the present plan and ground revision."""
    try:
        content: str | None = plan_to_fly(mission).content_sha256
    except Refused:
        content = None
    return {"content_sha256": content, "ground_revision": ground_revision()}
