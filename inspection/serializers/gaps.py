"""Gaps as GeoJSON features."""

import json
from typing import Any

from inspection.models import Asset, AssetKind, GapKind, GapState
from inspection.selectors import asset_detail, asset_label
from inspection.selectors.gaps import DrawnGap, GapSummary
from inspection.serializers.features import collection_serializer, feature_serializer
from inspection.serializers.gap_words import sentence, title
from inspection.services.repairs import Offer, Repaired
from workspace.admin_pages.author_names import AUTHOR_HELP, author_name
from workspace.api import strict_serializers as serializers
from workspace.jobs.serializers import Declared
from workspace.models import User

MAX_NOTE_LENGTH = 500


class GapAssetSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    kind = serializers.ChoiceField(choices=AssetKind.choices)
    label: Declared = serializers.CharField()
    detail = serializers.CharField()


class OfferSerializer(serializers.Serializer):
    action = serializers.CharField(help_text="what /repair takes")
    words = serializers.CharField()
    parameter = serializers.CharField(help_text="of /repair, may be empty: positions, way, voltages_v")
    choices = serializers.ListField(child=serializers.JSONField(), help_text="values for the parameter, each with its words")
    preview = serializers.JSONField(allow_null=True, help_text="FeatureCollection of what it would draw; null in lists")
    refused = serializers.CharField(help_text="why it cannot be done now; mostly empty")


class GapPropertiesSerializer(serializers.Serializer):
    kind = serializers.ChoiceField(choices=GapKind.choices)
    state = serializers.ChoiceField(choices=GapState.choices)
    title = serializers.CharField()
    sentence = serializers.CharField()
    asset = GapAssetSerializer(allow_null=True)
    other_asset = GapAssetSerializer(allow_null=True)
    position = serializers.ListField(child=serializers.FloatField(), help_text="lon, lat")
    details = serializers.DictField(help_text="figures with units in their names")
    cut_off_m = serializers.FloatField(help_text="length of network that depends on it")
    repairs = OfferSerializer(many=True)
    note = serializers.CharField()
    decided_by = serializers.CharField(allow_null=True, help_text=AUTHOR_HELP)
    decided_at = serializers.DateTimeField(allow_null=True)
    found_at = serializers.DateTimeField()


GapFeatureSerializer = feature_serializer("GapFeature", GapPropertiesSerializer)
GapCollectionSerializer = collection_serializer("GapCollection", GapFeatureSerializer)


class GapSummarySerializer(serializers.Serializer):
    kinds = serializers.DictField(child=serializers.DictField(child=serializers.IntegerField()), help_text="number by kind, then state")
    is_current = serializers.BooleanField(help_text="false while the ground has changed and is not yet searched again")
    searched_at = serializers.DateTimeField(allow_null=True, help_text="null before the first search")


class RepairSerializer(serializers.Serializer):
    action = serializers.CharField(max_length=40)
    positions = serializers.JSONField(required=False, help_text="place_towers: [[lon, lat], …]; without it evenly")
    way = serializers.CharField(max_length=20, required=False, help_text="carries: road, railway, path, water or pipeline")
    voltages_v = serializers.JSONField(required=False, help_text="set_voltages: [110000]; without it as offered")


class UndoRepairSerializer(serializers.Serializer):
    entries = serializers.ListField(child=serializers.IntegerField(min_value=1), min_length=1, max_length=5_000)


class DismissSerializer(serializers.Serializer):
    note = serializers.CharField(max_length=MAX_NOTE_LENGTH, allow_blank=True, default="")


class RepairedSerializer(serializers.Serializer):
    gap = GapFeatureSerializer(allow_null=True)
    entries = serializers.ListField(child=serializers.IntegerField(), help_text="of the history, oldest first")
    said = serializers.CharField(help_text="what was done, in words")
    is_current = serializers.BooleanField(help_text="whether the ground has been searched again already")


def gap_feature(gap: DrawnGap, repairs: list[dict[str, Any]], reader: User) -> dict[str, Any]:
    """`gap` comes with `geometry_json` from inspection.selectors.gaps."""
    properties = {
        "kind": gap.kind,
        "state": gap.state,
        "title": title(gap.kind, gap.details),
        "sentence": sentence(gap.kind, gap.details),
        "asset": _asset_json(gap.asset),
        "other_asset": _asset_json(gap.other_asset),
        "position": list(gap.position.coords),
        "details": gap.details,
        "cut_off_m": gap.cut_off_m,
        "repairs": repairs,
        "note": gap.note,
        "decided_by": author_name(gap.decided_by, reader),
        "decided_at": gap.decided_at,
        "found_at": gap.found_at,
    }
    return {"type": "Feature", "id": gap.pk, "geometry": json.loads(gap.geometry_json), "properties": properties}


def offer_json(offer: Offer, preview: dict[str, Any] | None = None, refused: str = "") -> dict[str, Any]:
    choices = [{"value": value, "words": words} for value, words in offer.choices]
    return {
        "action": offer.action, "words": offer.words, "parameter": offer.parameter, "choices": choices, "preview": preview,
        "refused": refused,
    }  # fmt: skip


def summary_json(summary: GapSummary, *, is_current: bool) -> dict[str, Any]:
    return {"kinds": summary.counts, "is_current": is_current, "searched_at": summary.searched_at}


def repaired_json(repaired: Repaired, feature: dict[str, Any] | None, *, is_current: bool) -> dict[str, Any]:
    return {"gap": feature, "entries": repaired.entries, "said": repaired.said, "is_current": is_current}


def _asset_json(asset: Asset | None) -> dict[str, Any] | None:
    return {"id": asset.pk, "kind": asset.kind, "label": asset_label(asset), "detail": asset_detail(asset)} if asset else None
