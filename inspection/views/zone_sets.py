"""Zone sets: their sources, versions and subscriptions."""

from django.db import transaction
from django.http import Http404
from django.urls import reverse
from django.utils.translation import gettext as _
from drf_spectacular.utils import extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import ImportKind, ProposalOrigin, ZoneSet, ZoneSubscription
from inspection.selectors.imports import proposal_of_id
from inspection.selectors.zone_sets import BY_NAME, NEWEST_VERSION_FIRST, CountedZoneSet, versions_of, zone_sets, zone_subscriptions
from inspection.serializers.imports import ProposalSerializer, proposal_json
from inspection.serializers.zone_sets import (
    FetchJobSerializer,
    RollBackSerializer,
    SubscriptionChangeSerializer,
    SubscriptionInputSerializer,
    ZoneSetPageSerializer,
    ZoneSetSerializer,
    ZoneSetVersionPageSerializer,
    ZoneSubscriptionPageSerializer,
    ZoneSubscriptionSerializer,
    subscription_json,
    version_json,
    zone_set_json,
)
from inspection.services.imports.subscriptions import AlreadySubscribed, ask_to_fetch, change_subscription, subscribe, unsubscribe
from inspection.services.imports.zone_sets import empty_zone_set
from inspection.services.proposals.pipeline import start_proposal
from inspection.services.proposals.zones import roll_back_name
from inspection.tasks import send_job_of
from inspection.views.parameters import invalid
from workspace.api.errors import ApiProblem
from workspace.api.idempotency import idempotent
from workspace.api.paging import page_of
from workspace.api.permissions import CURATORS
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.tasks import send_job_on_commit


def _zone_set(set_id: int) -> CountedZoneSet:
    try:
        return zone_sets().get(pk=set_id)
    except ZoneSet.DoesNotExist as error:
        raise Http404 from error


def _subscription(subscription_id: int) -> ZoneSubscription:
    try:
        return zone_subscriptions().get(pk=subscription_id)
    except ZoneSubscription.DoesNotExist as error:
        raise Http404 from error


class ZoneSetList(APIView):
    @extend_schema(
        operation_id="list_zone_sets",
        summary="Zone sets and their sources",
        description="What a source says of itself, and when it was asked. A set that was emptied is listed without zones.",
        parameters=PAGE_PARAMETERS,
        responses=ZoneSetPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        page = page_of(request, zone_sets(), order=BY_NAME)
        return Response({"results": [zone_set_json(zone_set, request.user) for zone_set in page.rows], "next": page.next})


class ZoneSetDetail(APIView):
    write_roles = CURATORS

    @extend_schema(operation_id="get_zone_set", summary="One zone set", responses=ZoneSetSerializer)
    def get(self, request: SignedInRequest, set_id: int) -> Response:
        return Response(zone_set_json(_zone_set(set_id), request.user))

    @extend_schema(
        operation_id="empty_zone_set",
        summary="Delete all zones of a set",
        description="The set stays, without zones: each of its versions can be brought back. What is fetched for it is paused.",
        responses={204: None},
    )
    def delete(self, request: SignedInRequest, set_id: int) -> Response:
        empty_zone_set(zone_set=_zone_set(set_id), actor=request.user)
        return Response(status=204)


class ZoneSetVersions(APIView):
    @extend_schema(
        operation_id="list_zone_set_versions",
        summary="The states that a set had, newest first",
        parameters=PAGE_PARAMETERS,
        responses=ZoneSetVersionPageSerializer,
    )
    def get(self, request: SignedInRequest, set_id: int) -> Response:
        page = page_of(request, versions_of(_zone_set(set_id)), order=NEWEST_VERSION_FIRST, default_limit=50)
        return Response({"results": [version_json(version, request.user) for version in page.rows], "next": page.next})


class ZoneSetRollBack(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="roll_back_zone_set",
        summary="Propose a set's earlier state",
        description="It is shown as a difference and applied like any other import.",
        request=RollBackSerializer,
        responses={202: ProposalSerializer},
    )
    @idempotent
    def post(self, request: SignedInRequest, set_id: int) -> Response:
        body = RollBackSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        zone_set = _zone_set(set_id)
        version = zone_set.versions.select_related("zone_set").defer("content").filter(number=body.validated_data["version"]).first()
        if version is None:
            raise invalid("version", _("The set has no such version."))
        with transaction.atomic():
            proposal = start_proposal(
                kind=ImportKind.ZONES, origin=ProposalOrigin.ROLL_BACK, upload=None, file_name=roll_back_name(version),
                parameters={"set": zone_set.pk, "set_name": zone_set.name, "version": version.number}, provenance={},
                created_by=request.user,
            )  # fmt: skip
            send_job_of(proposal)
        answer = Response(proposal_json(proposal_of_id(proposal.pk), request.user), status=202)
        answer["Location"] = reverse("api-import", args=[proposal.pk])
        return answer


class ZoneSubscriptionList(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="list_zone_subscriptions",
        summary="What is fetched",
        parameters=PAGE_PARAMETERS,
        responses=ZoneSubscriptionPageSerializer,
    )
    def get(self, request: Request) -> Response:
        page = page_of(request, zone_subscriptions(), order=BY_NAME)
        return Response({"results": [subscription_json(subscription) for subscription in page.rows], "next": page.next})

    @extend_schema(
        operation_id="create_zone_subscription",
        summary="Have a zone set fetched",
        description="What is fetched is proposed as a difference. Nothing changes before somebody applies it.",
        request=SubscriptionInputSerializer,
        responses={201: ZoneSubscriptionSerializer},
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        body = SubscriptionInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        try:
            subscription = subscribe(actor=request.user, **body.validated_data)
        except AlreadySubscribed as error:
            raise ApiProblem(409, "already_subscribed", str(error)) from error
        answer = Response(subscription_json(_subscription(subscription.pk)), status=201)
        answer["Location"] = reverse("api-zone-subscription", args=[subscription.pk])
        return answer


class ZoneSubscriptionDetail(APIView):
    write_roles = CURATORS

    @extend_schema(operation_id="get_zone_subscription", summary="One subscription", responses=ZoneSubscriptionSerializer)
    def get(self, request: Request, subscription_id: int) -> Response:
        return Response(subscription_json(_subscription(subscription_id)))

    @extend_schema(
        operation_id="change_zone_subscription",
        summary="Change what is fetched, or pause it",
        request=SubscriptionChangeSerializer(partial=True),
        responses=ZoneSubscriptionSerializer,
    )
    def patch(self, request: SignedInRequest, subscription_id: int) -> Response:
        subscription = _subscription(subscription_id)
        body = SubscriptionChangeSerializer(data=request.data, partial=True)
        body.is_valid(raise_exception=True)
        change_subscription(subscription=subscription, actor=request.user, **body.validated_data)
        return Response(subscription_json(_subscription(subscription_id)))

    @extend_schema(
        operation_id="delete_zone_subscription",
        summary="Fetch no more",
        description="The set and its zones stay.",
        responses={204: None},
    )
    def delete(self, request: SignedInRequest, subscription_id: int) -> Response:
        unsubscribe(subscription=_subscription(subscription_id), actor=request.user)
        return Response(status=204)


class ZoneSubscriptionFetch(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="fetch_zone_subscription",
        summary="Fetch now",
        description="The job's result names the new proposal, if the source has something new.",
        request=None,
        responses={202: FetchJobSerializer},
    )
    def post(self, request: SignedInRequest, subscription_id: int) -> Response:
        with transaction.atomic():
            job = ask_to_fetch(subscription=_subscription(subscription_id), actor=request.user)
            send_job_on_commit(job)
        return Response({"job": str(job.pk)}, status=202)
