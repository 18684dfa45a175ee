"""Campaigns: list, create, plan again, delete."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from uuid import UUID

from django.http import Http404, StreamingHttpResponse
from django.urls import reverse
from django.utils.text import slugify
from django.utils.translation import gettext as _
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.exporters.text_pieces import cell, csv_pieces
from missions.models import Campaign
from missions.serializers.campaigns import (
    DAY_COLUMNS,
    CampaignInputSerializer,
    CampaignPageSerializer,
    CampaignPlanSerializer,
    CampaignRoutesSerializer,
    CampaignSerializer,
    campaign_json,
    campaign_routes_json,
    campaign_summary,
    day_rows,
)
from missions.serializers.inputs import plan_request
from missions.services.campaigns import CampaignIsPlanned, MissionsInUse, create_campaign, delete_campaign, plan_campaign_again
from missions.views.plans import PLAN_EXAMPLE
from missions.views.problems import api_problems
from operation.reasons import Reason
from planning.campaigns.rules import rules_from_json
from workspace.api.errors import ApiProblem
from workspace.api.idempotency import idempotent
from workspace.api.paging import page_of
from workspace.api.renderers import OneAnswer
from workspace.api.schema import PAGE_PARAMETERS, request_example
from workspace.api.signed_in import SignedInRequest
from workspace.api.throttling import ScopedRate
from workspace.jobs.services import TooManyJobs
from workspace.models import User
from workspace.reason_texts import reason_text

PLANNED_BY_JOB = "A job plans it, see `job` of the campaign; its missions, days and unassigned targets are there once it is done."
EXAMPLE = {"name": "Valley lines", **PLAN_EXAMPLE, "rules": {"start": [9.52, 47.14], "crews": 1, "reach_m": 3000}}


def _campaign(user: User, campaign_id: UUID) -> Campaign:
    campaign = Campaign.objects.filter(organisation=user.organisation, pk=campaign_id).select_related("author").first()
    if campaign is None:
        raise Http404
    return campaign


@contextmanager
def _problems() -> Iterator[None]:
    with api_problems():
        try:
            yield
        except CampaignIsPlanned as error:
            raise ApiProblem(409, "campaign_is_planned", _("The campaign is being planned. Stop that first.")) from error
        except MissionsInUse as error:
            message = reason_text(Reason("campaign_missions_in_use", {"count": error.count}))
            raise ApiProblem(409, "missions_in_use", message) from error
        except Campaign.DoesNotExist as error:
            raise Http404 from error
        except TooManyJobs as error:
            raise ApiProblem(429, "too_many_jobs", _("Enough campaigns are being planned."), retry_after_s=30) from error


class _PlansCampaigns(APIView):
    throttle_scope = "plans"

    def get_throttles(self) -> list[Any]:
        return [ScopedRate()] if self.request.method == "POST" else []


class CampaignList(_PlansCampaigns):
    @extend_schema(
        operation_id="list_campaigns",
        summary="Campaigns, the last changed first",
        parameters=[OpenApiParameter("text", str, description="part of the name"), *PAGE_PARAMETERS],
        responses=CampaignPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        text = request.query_params.get("text", "").strip()[:100].replace("\0", "")
        rows = (
            Campaign.objects.filter(organisation=request.user.organisation, name__icontains=text)
            .select_related("author")
            .defer("request", "rules", "schedule")
        )
        page = page_of(request, rows, order=("-updated_at", "-pk"))
        return Response({"results": [campaign_summary(campaign) for campaign in page.rows], "next": page.next})

    @extend_schema(
        operation_id="create_campaign",
        summary="Plan missions from several launch sites over several days",
        description="Launch sites are chosen so that every target is in reach of one, missions are planned from each, and crews drive from "
        f"site to site within their working days. {PLANNED_BY_JOB}",
        request=CampaignInputSerializer,
        responses={202: CampaignSerializer},
        examples=[request_example(EXAMPLE)],
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        user = request.user
        values = CampaignInputSerializer.read(request.data, organisation=user.organisation)
        with _problems():
            campaign = create_campaign(
                organisation=user.organisation,
                author=user,
                name=values["name"],
                request=plan_request(values),
                rules=rules_from_json(values["rules"]),
            )
        return Response(campaign_json(campaign), status=202, headers={"Location": reverse("api-campaign", args=[campaign.pk])})


class CampaignDetail(APIView):
    @extend_schema(operation_id="get_campaign", summary="A campaign with its days and missions", responses=CampaignSerializer)
    def get(self, request: SignedInRequest, campaign_id: UUID) -> Response:
        return Response(campaign_json(_campaign(request.user, campaign_id)))

    @extend_schema(
        operation_id="delete_campaign",
        summary="Delete a campaign and those of its missions that are not approved",
        responses={204: None},
    )
    def delete(self, request: SignedInRequest, campaign_id: UUID) -> Response:
        campaign = _campaign(request.user, campaign_id)
        with _problems():
            delete_campaign(campaign=campaign, actor=request.user)
        return Response(status=204)


class CampaignRoutes(APIView):
    @extend_schema(operation_id="get_campaign_routes", summary="Routes of a campaign as GeoJSON", responses=CampaignRoutesSerializer)
    def get(self, request: SignedInRequest, campaign_id: UUID) -> Response:
        return Response(campaign_routes_json(_campaign(request.user, campaign_id)))


class CampaignDaysFile(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "exports"

    @extend_schema(
        operation_id="export_campaign_days",
        summary="Days of the crews as CSV",
        description="A row for each stay at a site and each drive back. Times are minutes after the crew left the start that day.",
        responses={(200, "text/csv"): OpenApiTypes.STR, 409: OpenApiResponse(description="The campaign is not planned: there is no file.")},
    )
    def get(self, request: SignedInRequest, campaign_id: UUID) -> StreamingHttpResponse:
        campaign = _campaign(request.user, campaign_id)
        if campaign.schedule is None:
            raise ApiProblem(409, "not_planned", _("The campaign is not planned yet."))
        pieces = csv_pieces(DAY_COLUMNS, (map(cell, row) for row in day_rows(campaign)))
        response = StreamingHttpResponse(pieces, content_type="text/csv; charset=utf-8")
        response["Content-Disposition"] = f'attachment; filename="{slugify(campaign.name) or "campaign"}-days.csv"'
        response["Cache-Control"] = "private, no-cache"
        return response


class CampaignPlan(_PlansCampaigns):
    @extend_schema(
        operation_id="plan_campaign",
        summary="Plan a campaign again with other rules",
        description=f"New missions replace those it has. {PLANNED_BY_JOB}",
        request=CampaignPlanSerializer,
        responses={
            202: CampaignSerializer,
            409: OpenApiResponse(description="`campaign_is_planned`, or `missions_in_use`: some are approved or have flown."),
        },
    )
    @idempotent
    def post(self, request: SignedInRequest, campaign_id: UUID) -> Response:
        campaign = _campaign(request.user, campaign_id)
        values = CampaignPlanSerializer.read(request.data)
        with _problems():
            campaign = plan_campaign_again(campaign=campaign, actor=request.user, rules=rules_from_json(values["rules"]))
        return Response(campaign_json(campaign), status=202)
