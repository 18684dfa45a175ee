"""Shapes of findings."""

from typing import Any

from rest_framework import serializers as answers

from missions.serializers.uavs import PointSerializer
from results.categories import BY_CODE, CATEGORIES, COMPONENTS
from results.finding_states import FindingState
from results.models import Evidence, Finding, FindingComment, Observation, ObservationOutcome, SeveritySource
from results.models.findings import MAX_MARKS, MAX_NOTE_LENGTH, MAX_REFERENCE_LENGTH
from results.serializers.media import MAX_ID
from workspace.api import strict_serializers as serializers
from workspace.models import User

STATES = [state.value for state in FindingState]
SHAPES = ("box", "polygon")
MAX_POINTS = 200
MAX_LOOKED_AT = 500  # findings of one mission
MAX_PIXEL = 1e6


class ShapeSerializer(serializers.Serializer):
    """A mark in pixels of the upright original, from its top left corner: x, y, width and height of a box, or points of a polygon."""

    type = serializers.ChoiceField(choices=SHAPES)
    x = serializers.FloatField(required=False, min_value=0.0, max_value=MAX_PIXEL)
    y = serializers.FloatField(required=False, min_value=0.0, max_value=MAX_PIXEL)
    width = serializers.FloatField(required=False, min_value=1.0, max_value=MAX_PIXEL)
    height = serializers.FloatField(required=False, min_value=1.0, max_value=MAX_PIXEL)
    points = serializers.ListField(
        child=serializers.ListField(child=serializers.FloatField(min_value=0.0, max_value=MAX_PIXEL), min_length=2, max_length=2),
        required=False, min_length=3, max_length=MAX_POINTS,
    )  # fmt: skip

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        wanted = {"x", "y", "width", "height"} if attrs["type"] == "box" else {"points"}
        if set(attrs) - {"type"} != wanted:
            raise serializers.ValidationError("A box has x, y, width and height; a polygon has points.")
        return attrs


class MarkSerializer(serializers.Serializer):
    medium = serializers.UUIDField()
    shape = ShapeSerializer(required=False, allow_null=True, help_text="null: the whole picture")


class FindingInputSerializer(serializers.Serializer):
    """What is not stated is taken from the first medium: asset, target, mission."""

    category = serializers.ChoiceField(choices=list(BY_CODE))
    severity = serializers.IntegerField(min_value=1, max_value=4, help_text="1 danger, 2 repair, 3 watch, 4 note")
    note = serializers.CharField(required=False, allow_blank=True, max_length=MAX_NOTE_LENGTH)
    evidence = serializers.ListField(child=MarkSerializer(), required=False, max_length=MAX_MARKS)
    mission = serializers.UUIDField(required=False, allow_null=True)
    target = serializers.IntegerField(required=False, allow_null=True, min_value=1, max_value=MAX_ID)
    asset = serializers.IntegerField(required=False, allow_null=True, min_value=1, max_value=MAX_ID)
    due_on = answers.DateField(required=False, allow_null=True)
    work_reference = serializers.CharField(required=False, allow_blank=True, max_length=MAX_REFERENCE_LENGTH)


class FindingChangeSerializer(serializers.Serializer):
    category = serializers.ChoiceField(choices=list(BY_CODE), required=False)
    severity = serializers.IntegerField(min_value=1, max_value=4, required=False)
    note = serializers.CharField(required=False, allow_blank=True, max_length=MAX_NOTE_LENGTH)
    state = serializers.ChoiceField(choices=STATES, required=False)
    asset = serializers.IntegerField(required=False, allow_null=True, min_value=1, max_value=MAX_ID)
    due_on = answers.DateField(required=False, allow_null=True)
    work_reference = serializers.CharField(required=False, allow_blank=True, max_length=MAX_REFERENCE_LENGTH)


class ObservationInputSerializer(serializers.Serializer):
    medium = serializers.UUIDField(help_text="a later photo of the asset")
    outcome = serializers.ChoiceField(choices=ObservationOutcome.choices)


class CommentInputSerializer(serializers.Serializer):
    text = serializers.CharField(max_length=MAX_NOTE_LENGTH)


class LookAgainSerializer(serializers.Serializer):
    findings = serializers.ListField(child=serializers.UUIDField(), allow_empty=False, max_length=MAX_LOOKED_AT)
    name = serializers.CharField(max_length=200, required=False, allow_blank=True, help_text="of the mission; without one: after the asset")


class EvidenceSerializer(answers.Serializer):
    id = answers.IntegerField()
    medium = answers.UUIDField()
    shape = ShapeSerializer(allow_null=True)
    author = answers.CharField(allow_null=True)
    created_at = answers.DateTimeField()


class InspectionFindingSerializer(answers.Serializer):
    id = answers.UUIDField()
    number = answers.IntegerField(help_text="within your organisation")
    category = answers.CharField()
    category_name = answers.CharField(help_text="in your language")
    scheme = answers.CharField(help_text="the list of categories that it was made with")
    severity = answers.IntegerField()
    severity_source = answers.ChoiceField(choices=SeveritySource.choices)
    note = answers.CharField(allow_blank=True)
    state = answers.ChoiceField(choices=STATES)
    asset = answers.IntegerField(allow_null=True)
    asset_label = answers.CharField(allow_blank=True)
    mission = answers.UUIDField(allow_null=True)
    target = answers.IntegerField(allow_null=True)
    position = PointSerializer(allow_null=True)
    due_on = answers.DateField(allow_null=True)
    done_at = answers.DateTimeField(allow_null=True)
    work_reference = answers.CharField(allow_blank=True)
    first_seen_at = answers.DateTimeField()
    last_seen_at = answers.DateTimeField()
    evidence = EvidenceSerializer(many=True)
    created_by = answers.CharField(allow_null=True)
    created_at = answers.DateTimeField()
    updated_at = answers.DateTimeField()
    revision = answers.IntegerField()


class InspectionFindingPageSerializer(answers.Serializer):
    results = InspectionFindingSerializer(many=True)
    next = answers.CharField(allow_null=True, help_text="path and query of the next page")


class ObservationSerializer(answers.Serializer):
    medium = answers.UUIDField()
    outcome = answers.ChoiceField(choices=ObservationOutcome.choices)
    observed_at = answers.DateTimeField()
    author = answers.CharField(allow_null=True)


class FindingCommentSerializer(answers.Serializer):
    id = answers.IntegerField()
    text = answers.CharField()
    author = answers.CharField(allow_null=True)
    created_at = answers.DateTimeField()


class InspectionFindingDetailSerializer(InspectionFindingSerializer):
    observations = ObservationSerializer(many=True, help_text="later visits that looked for it")
    comments = FindingCommentSerializer(many=True)


class CategorySerializer(answers.Serializer):
    code = answers.CharField()
    component = answers.CharField()
    component_name = answers.CharField()
    name = answers.CharField()
    needs_note = answers.BooleanField()


class CategoryListSerializer(answers.Serializer):
    scheme = answers.CharField()
    categories = CategorySerializer(many=True)


def categories_json(translate: Any) -> list[dict[str, Any]]:
    return [
        {
            "code": one.code,
            "component": one.component,
            "component_name": translate(COMPONENTS[one.component]),
            "name": translate(one.name),
            "needs_note": one.needs_note,
        }
        for one in CATEGORIES
    ]


PLAIN_FIELDS = (
    "number", "category", "scheme", "severity", "severity_source", "note", "state", "asset_label", "due_on", "done_at", "work_reference",
    "first_seen_at", "last_seen_at", "created_at", "updated_at", "revision",
)  # fmt: skip


def finding_json(finding: Finding, category_name: str) -> dict[str, Any]:
    position = finding.position
    return {name: getattr(finding, name) for name in PLAIN_FIELDS} | {
        "id": str(finding.pk),
        "category_name": category_name,
        "asset": finding.asset_id,
        "mission": None if finding.mission_id is None else str(finding.mission_id),
        "target": finding.target_id,
        "position": None if position is None else {"type": "Point", "coordinates": [position.x, position.y]},
        "evidence": [evidence_json(row) for row in finding.evidence.all()],
        "created_by": author_name(finding.created_by),
    }


def detail_json(finding: Finding, category_name: str) -> dict[str, Any]:
    observations = finding.observations.select_related("author")
    return finding_json(finding, category_name) | {
        "observations": [_observation_json(row) for row in observations],
        "comments": [comment_json(row) for row in finding.comments.select_related("author")],
    }


def evidence_json(row: Evidence) -> dict[str, Any]:
    return {
        "id": row.pk,
        "medium": str(row.medium_id),
        "shape": row.shape,
        "author": author_name(row.author),
        "created_at": row.created_at,
    }


def comment_json(row: FindingComment) -> dict[str, Any]:
    return {"id": row.pk, "text": row.text, "author": author_name(row.author), "created_at": row.created_at}


def _observation_json(row: Observation) -> dict[str, Any]:
    return {
        "medium": str(row.medium_id),
        "outcome": row.outcome,
        "observed_at": row.observed_at,
        "author": author_name(row.author),
    }


def author_name(user: User | None) -> str | None:
    return None if user is None else user.display_name
