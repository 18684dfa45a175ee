"""Offers of another plan in the shapes of the API."""

from collections.abc import Mapping
from typing import Any

from rest_framework import serializers

from missions.models import OfferState, ReplanOffer
from workspace.api.fields import WhySerializer
from workspace.reason_texts import column_text, reasons_of_column, why_text

REVISIONS = {OfferState.COMPUTING: 1, OfferState.OPEN: 2}  # an offer is computed once and decided once
DECIDED = 3


def revision_of_offer(offer: ReplanOffer) -> int:
    return REVISIONS.get(OfferState(offer.state), DECIDED)


class ReplanOfferSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    mission = serializers.UUIDField(help_text="the mission that flies")
    code = serializers.CharField(help_text="why: uav-out, zone-active, battery-short, asked-for")
    cause = serializers.JSONField()
    state = serializers.ChoiceField(choices=OfferState.choices)
    revision = serializers.IntegerField(help_text="the ETag")
    difference = serializers.JSONField(help_text="what would change, per UAV and target; see services/replanning/difference.py")
    continuation = serializers.UUIDField(allow_null=True, help_text="the planned mission that is offered")
    created_at = serializers.DateTimeField()
    decided_by = serializers.CharField(allow_null=True)
    decided_at = serializers.DateTimeField(allow_null=True)
    outcome = serializers.CharField(help_text="why it is outdated or impossible")
    outcome_why = WhySerializer(many=True, help_text="the same for programs; empty where only a text is known")


class ReplanOfferPageSerializer(serializers.Serializer):
    results = ReplanOfferSerializer(many=True)
    next = serializers.CharField(allow_null=True)


class ReplanAskedSerializer(serializers.Serializer):
    job = serializers.UUIDField(help_text="its state: GET the address in Location")
    offer = serializers.UUIDField()


def render_difference(difference: Mapping[str, Any]) -> dict[str, Any]:
    """Return the difference from services/replanning/difference.py in the reader's language, without the `basis` of its computation."""
    shown = {name: value for name, value in difference.items() if name != "basis"}
    if "uavs" in shown:
        shown["uavs"] = [{**entry, "why": why_text(entry.get("reasons", ()), entry["why"], "\n")} for entry in shown["uavs"]]
    if "targets" in shown:
        shown["targets"] = [{**entry, "message": why_text(entry.get("why", ()), entry["message"], "\n")} for entry in shown["targets"]]
    return shown


def offer_outcome(offer: ReplanOffer) -> dict[str, Any]:
    return {
        "outcome": column_text(offer.outcome_why, offer.outcome, "\n"),
        "outcome_why": reasons_of_column(offer.outcome_why, offer.outcome),
    }


def offer_json(offer: ReplanOffer) -> dict[str, Any]:
    return {
        "id": str(offer.pk),
        "mission": str(offer.mission_id),
        "code": offer.code,
        "cause": offer.cause,
        "state": offer.state,
        "revision": revision_of_offer(offer),
        "difference": render_difference(offer.difference),
        "continuation": None if offer.continuation_id is None else str(offer.continuation_id),
        "created_at": offer.created_at,
        "decided_by": offer.decided_by.username if offer.decided_by else None,
        "decided_at": offer.decided_at,
        **offer_outcome(offer),
    }
