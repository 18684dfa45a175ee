"""Saved selections, in and out."""

from typing import Any

from inspection.models import Asset
from inspection.selectors import asset_detail, label_now
from missions.fields import PositionField
from missions.models import SavedSelection, TargetPriority
from missions.models.missions import between_ends
from missions.selectors.selections import KeptTarget, kept_targets
from missions.serializers.inputs import OptionsSerializer, TargetInputSerializer
from missions.serializers.view_plans import TaskOutputSerializer
from workspace.api import strict_serializers as serializers
from workspace.jobs.serializers import Declared


class SelectionInputSerializer(OptionsSerializer):
    """A name, and targets as in a mission. UAVs, ties, locks, options, external ids and attributes are not saved."""

    uavs: Declared = None
    objective: Declared = None
    return_to_start: Declared = None
    locks: Declared = None
    name = serializers.CharField(max_length=100)
    targets = TargetInputSerializer(many=True, allow_empty=False)


class SelectionTargetSerializer(serializers.Serializer):
    asset = serializers.IntegerField(allow_null=True)
    label: Declared = serializers.CharField()
    detail = serializers.CharField(help_text="the asset's second fact; may be empty")
    length_m = serializers.FloatField(allow_null=True)
    kind = serializers.CharField(allow_null=True)
    line = serializers.IntegerField(allow_null=True, help_text="of a support: the line of the highest voltage that it carries")
    position = PositionField(allow_null=True, help_text="as picked, the middle between the ends of a stretch, else the asset's centre")
    stretch = serializers.ListField(child=PositionField(), allow_null=True)
    is_point = serializers.BooleanField()
    task = TaskOutputSerializer()
    priority = serializers.ChoiceField(choices=TargetPriority.choices)
    sensor = serializers.CharField(help_text="that its UAV must have; may be empty")


class SelectionSummarySerializer(serializers.Serializer):
    id = serializers.IntegerField()
    name = serializers.CharField()
    author = serializers.CharField(allow_null=True)
    target_count = serializers.IntegerField()
    revision = serializers.IntegerField(help_text="the ETag")
    updated_at = serializers.DateTimeField()


class SelectionSerializer(SelectionSummarySerializer):
    targets = SelectionTargetSerializer(many=True, help_text="those that are still in the data")
    missing = serializers.ListField(child=serializers.CharField(), help_text="what the others were called")


class SelectionPageSerializer(serializers.Serializer):
    results = SelectionSummarySerializer(many=True)
    next = serializers.CharField(allow_null=True)


def selection_summary(selection: SavedSelection) -> dict[str, Any]:
    return {
        "id": selection.pk,
        "name": selection.name,
        "author": selection.author.username if selection.author else None,
        "target_count": len(selection.targets),
        "revision": selection.revision,
        "updated_at": selection.updated_at,
    }


def selection_json(selection: SavedSelection) -> dict[str, Any]:
    kept = kept_targets(selection)
    return selection_summary(selection) | {
        "targets": [_target(target) for target in kept if not target.is_missing],
        "missing": [target.value["label"] for target in kept if target.is_missing],
    }


def _shown_at(stretch: list[list[float]] | None, asset: Asset | None) -> list[float] | None:
    if stretch is not None:
        return list(between_ends(stretch).coords)
    return None if asset is None else list(asset.centre.coords)


def _target(target: KeptTarget) -> dict[str, Any]:
    value, asset = target.value, target.asset
    return {
        "asset": value["asset"],
        "label": value["label"] if asset is None else label_now(asset, value["label"]),
        "detail": "" if asset is None else asset_detail(asset),
        "length_m": None if asset is None else asset.length_m,
        "kind": None if asset is None else asset.kind,
        "line": None if asset is None else asset.line_id,
        "position": value["position"] or _shown_at(value["stretch"], asset),
        "stretch": value["stretch"],
        "is_point": value["position"] is not None,
        "task": value["task"],
        "priority": value.get("priority", TargetPriority.NORMAL),
        "sensor": value.get("sensor", ""),
    }
