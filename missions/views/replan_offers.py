"""Offers of another plan for the rest of a flying mission: request, read, accept, decline."""

from collections.abc import Callable
from uuid import UUID

from django.http import Http404
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.models import ReplanOffer
from missions.serializers import replan_offers as shapes
from missions.services.replanning import accept_offer, ask_for_offer, decline_offer
from missions.views.missions import IF_MATCH, IF_MATCH_OPTIONAL, expected_revision, mission_or_404, stated_revision
from missions.views.plans import job_answer
from missions.views.problems import api_problems, refusals
from workspace.api.errors import ApiProblem
from workspace.api.idempotency import idempotent
from workspace.api.paging import page_of
from workspace.api.permissions import FLYING
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.models import User
from workspace.tasks import send_job_on_commit

NEWEST_FIRST = ("-created_at", "-pk")
REFUSED = {
    409: OpenApiResponse(description="It cannot be done: `details.reasons` has each reason. An outdated offer can be worked out again."),
    412: OpenApiResponse(description="The offer is no longer as it was seen."),
}
REFUSED_UNSEEN = REFUSED | {428: OpenApiResponse(description="If-Match is missing.")}


class MissionReplanOffers(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="list_replan_offers",
        summary="Other ways offered to do what is left of a mission, the newest first",
        parameters=PAGE_PARAMETERS,
        responses=shapes.ReplanOfferPageSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        page = page_of(request, mission.replan_offers.select_related("decided_by"), order=NEWEST_FIRST)
        return Response({"results": [shapes.offer_json(offer) for offer in page.rows], "next": page.next})

    @extend_schema(
        operation_id="ask_for_replan_offer",
        summary="Plan the rest again: what is left of a mission that flies",
        description="A job works it out; nothing that is flown changes until the offer is accepted.",
        request=None,
        responses={202: shapes.ReplanAskedSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        with refusals():
            offer, job = ask_for_offer(mission=mission, actor=request.user)
        send_job_on_commit(job)
        return job_answer(job, offer=str(offer.pk))


class ReplanOfferDetail(APIView):
    @extend_schema(operation_id="get_replan_offer", summary="One offer of another plan", responses=shapes.ReplanOfferSerializer)
    def get(self, request: SignedInRequest, offer_id: UUID) -> Response:
        return _answer(offer_or_404(request.user, offer_id))


class ReplanOfferAccept(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="accept_replan_offer",
        summary="Fly the offered plan",
        description="One confirmation: the continuing mission is approved, the UAVs whose route changes are held, given it while they"
        " hover, and started; what they leave of the mission that flies is taken over. Where a step fails a UAV stays held.",
        parameters=[IF_MATCH],
        request=None,
        responses={200: shapes.ReplanOfferSerializer, **REFUSED_UNSEEN},
    )
    @idempotent
    def post(self, request: SignedInRequest, offer_id: UUID) -> Response:
        return _decided(request, offer_id, accept_offer, expected_revision(request))


class ReplanOfferDecline(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="decline_replan_offer",
        summary="Leave the mission as it is",
        parameters=[IF_MATCH_OPTIONAL],
        request=None,
        responses={200: shapes.ReplanOfferSerializer, **REFUSED_UNSEEN},
    )
    @idempotent
    def post(self, request: SignedInRequest, offer_id: UUID) -> Response:
        return _decided(request, offer_id, decline_offer, stated_revision(request))


def offer_or_404(user: User, offer_id: UUID) -> ReplanOffer:
    offers = ReplanOffer.objects.select_related("mission", "decided_by")
    offer = offers.filter(pk=offer_id, mission__organisation=user.organisation, mission__deleted_at=None).first()
    if offer is None:
        raise Http404
    return offer


def _decided(request: SignedInRequest, offer_id: UUID, decide: Callable[..., ReplanOffer], expected: int | None) -> Response:
    offer = offer_or_404(request.user, offer_id)
    if expected is not None and shapes.offer_json(offer)["revision"] != expected:
        raise ApiProblem(412, "offer_changed", "The offer is no longer as it was seen. Load it again.")
    with api_problems(), refusals():
        decide(offer=offer, actor=request.user)
    return _answer(offer_or_404(request.user, offer_id))


def _answer(offer: ReplanOffer) -> Response:
    body = shapes.offer_json(offer)
    return Response(body, headers={"ETag": f'"{body["revision"]}"'})
