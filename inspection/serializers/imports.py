"""Uploads, proposals, and the lines of their differences."""

import json
from itertools import zip_longest
from typing import Any

from django.utils.translation import gettext as _

from inspection.models import MAX_REMOVED_PERCENT, ChangeAction, ImportKind, ImportProposal, ProposalOrigin, ProposalState, Region, Upload
from inspection.selectors.imports import DrawnChange
from inspection.serializers.features import GeometrySerializer
from inspection.services.imports.uploads import PART_BYTES
from inspection.services.proposals.reading import KINDS
from workspace.admin_pages.author_names import AUTHOR_HELP, author_name
from workspace.api import strict_serializers as serializers
from workspace.api.fields import FiniteFloatField, WhySerializer
from workspace.jobs.serializers import Declared
from workspace.models import Job, JobState, User
from workspace.reason_texts import column_text, reasons_of_column, why_text, with_message

MAX_REGION_NAME = 200


class UploadInputSerializer(serializers.Serializer):
    file_name = serializers.CharField(max_length=255)
    size_bytes = serializers.IntegerField(min_value=1)


class UploadSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    file_name = serializers.CharField()
    size_bytes = serializers.IntegerField()
    received_bytes = serializers.IntegerField(help_text="without a gap from the start: go on from here")
    part_bytes = serializers.IntegerField(help_text="the most that one part may have")
    is_complete = serializers.BooleanField()


class ProvenanceInputSerializer(serializers.Serializer):
    """A file's source, as far as the file itself does not state it."""

    source_address = serializers.URLField(max_length=500, required=False, allow_blank=True)
    licence = serializers.CharField(max_length=200, required=False, allow_blank=True)
    attribution = serializers.CharField(max_length=300, required=False, allow_blank=True)


class ParametersField(serializers.DictField):
    """Parameters of an import. `region` names the region that it joins or makes; without it the place decides."""

    def to_internal_value(self, data: Any) -> Any:
        values = super().to_internal_value(data)
        name = values.get("region", "")
        if not isinstance(name, str) or not name.isprintable() or len(name) > MAX_REGION_NAME:
            raise serializers.ValidationError({"region": [_("The name of a region is a text of at most 200 characters.")]})
        if Region.objects.filter(name=name.strip(), imports__is_synthetic=True).exists():
            raise serializers.ValidationError({"region": [_("Real data do not join the demo region. Name another one.")]})
        return values


class ImportInputSerializer(serializers.Serializer):
    kind = serializers.ChoiceField(choices=ImportKind.choices)
    upload = serializers.UUIDField(required=False, help_text="a complete upload; not for what is fetched")
    parameters = ParametersField(
        required=False,
        help_text="by kind: set_name; columns; vertical_datum; overpass_bbox [W, S, E, N]; of all: region (a name)",
    )
    provenance = ProvenanceInputSerializer(required=False)
    auto_apply = serializers.BooleanField(
        default=False,
        help_text="apply it once it is read, if no record and no value of it has a fault, it removes no more than `max_removed_percent` "
        "of the rows that its source has had, and it changes nothing about missions that are flown or were sent to UAVs; else it stays a "
        "proposal, and `held_back` says why. Not for terrain.",
    )
    max_removed_percent = FiniteFloatField(default=MAX_REMOVED_PERCENT, min_value=0.0, max_value=100.0, help_text="for `auto_apply`")

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        if attrs["auto_apply"] and attrs["kind"] not in KINDS:
            raise serializers.ValidationError({"auto_apply": [_("Imports of this kind are applied by somebody who has looked at them.")]})
        return attrs


class ParametersSerializer(serializers.Serializer):
    parameters = ParametersField(required=False)


class ProposalFaultSerializer(serializers.Serializer):
    place = serializers.CharField()
    message = serializers.CharField()
    why = WhySerializer(many=True, help_text="the message for programs; empty where only a text is known")
    position = serializers.ListField(child=serializers.FloatField(), allow_null=True, help_text="lon, lat")


class ProposalJobSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    state = serializers.ChoiceField(choices=JobState.choices)
    progress = serializers.FloatField()
    message = serializers.CharField()
    why = WhySerializer(many=True, help_text="the message for programs; empty where only a text is known")


class HeldBackSerializer(serializers.Serializer):
    code = serializers.ChoiceField(choices=["needs_mapping", "not_read", "removed", "flown_missions", "not_applied"])
    message: Declared = serializers.CharField()
    why = WhySerializer(many=True, help_text="the message for programs; empty where only a text is known")


class ProposalSerializer(serializers.Serializer):
    """The changes that a file would make. None of them counts before a user applies them."""

    id = serializers.UUIDField()
    kind = serializers.ChoiceField(choices=ImportKind.choices)
    origin = serializers.ChoiceField(choices=ProposalOrigin.choices)
    state = serializers.ChoiceField(choices=ProposalState.choices)
    file_name = serializers.CharField()
    size_bytes = serializers.IntegerField(allow_null=True)
    parameters = serializers.DictField()
    provenance = serializers.DictField()
    faults = ProposalFaultSerializer(many=True)
    summary = serializers.DictField(help_text="what is in the file")
    difference = serializers.DictField(child=serializers.IntegerField(), help_text="numbers by action, and unchanged")
    auto_apply = serializers.BooleanField()
    max_removed_percent = serializers.FloatField(help_text="the bound of `auto_apply`")
    held_back = HeldBackSerializer(
        many=True, help_text="why it was not applied by itself; empty: it was, was not asked to, or is being read"
    )
    job = ProposalJobSerializer(allow_null=True)
    created_by = serializers.CharField(allow_null=True, help_text=AUTHOR_HELP)
    created_at = serializers.DateTimeField()
    decided_by = serializers.CharField(allow_null=True, help_text=AUTHOR_HELP)
    decided_at = serializers.DateTimeField(allow_null=True)
    data_import = serializers.IntegerField(allow_null=True)


class ProposalPageSerializer(serializers.Serializer):
    results = ProposalSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="address of the next page")


class ChangePropertiesSerializer(serializers.Serializer):
    action = serializers.ChoiceField(choices=ChangeAction.choices)
    subject = serializers.CharField(help_text="asset kind, or zone")
    subject_id = serializers.IntegerField(allow_null=True, help_text="of the row that it changes")
    label: Declared = serializers.CharField()
    key = serializers.CharField(allow_blank=True, help_text="in the parameter `excluded` of apply it leaves this change out")
    before = serializers.DictField(allow_null=True)
    after = serializers.DictField(allow_null=True)


class ChangeFeatureSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["Feature"])
    id = serializers.IntegerField()
    geometry = GeometrySerializer(allow_null=True)
    properties = ChangePropertiesSerializer()


class ChangeCollectionSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["FeatureCollection"])
    features = ChangeFeatureSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="address of the next page")


def upload_json(upload: Upload) -> dict[str, Any]:
    return {
        "id": str(upload.pk),
        "file_name": upload.file_name,
        "size_bytes": upload.size_bytes,
        "received_bytes": upload.received_bytes,
        "part_bytes": PART_BYTES,
        "is_complete": upload.is_complete,
    }


def _job_json(job: Job) -> dict[str, Any]:
    why = reasons_of_column(job.message_why, job.message)
    message = column_text(job.message_why, job.message)
    return {"id": str(job.pk), "state": job.state, "progress": job.progress, "message": message, "why": why}


def proposal_json(proposal: ImportProposal, reader: User, *, is_brief: bool = False) -> dict[str, Any]:
    """Return a proposal; in a list without what only the open one needs, such as the samples and the preview of an asset file."""
    job = proposal.job
    whole = proposal.summary if reader.organisation_id == proposal.organisation_id else _without_external_ids(proposal.summary)
    summary = {name: value for name, value in whole.items() if not (is_brief and isinstance(value, dict | list))}
    if "notes" in summary:
        notes = zip_longest(summary["notes"], summary.pop("notes_why", ()))
        summary["notes"] = [why_text([why] if why else [], note) for note, why in notes]
    if "not_read" in summary:
        summary["not_read"] = [with_message(record) for record in summary["not_read"]]
    return {
        "id": str(proposal.pk),
        "kind": proposal.kind,
        "origin": proposal.origin,
        "state": proposal.state,
        "file_name": proposal.file_name,
        "size_bytes": proposal.upload and proposal.upload.size_bytes,
        "parameters": proposal.parameters,
        "provenance": proposal.provenance,
        "faults": [{"why": [], **with_message(fault)} for fault in proposal.faults],
        "summary": summary,
        "difference": proposal.difference,
        "auto_apply": proposal.auto_apply,
        "max_removed_percent": proposal.max_removed_percent,
        "held_back": [{"why": [], **with_message(reason)} for reason in proposal.held_back],
        "job": job and _job_json(job),
        "created_by": author_name(proposal.created_by, reader),
        "created_at": proposal.created_at,
        "decided_by": author_name(proposal.decided_by, reader),
        "decided_at": proposal.decided_at,
        "data_import": proposal.data_import_id,
    }


def _without_external_ids(summary: dict[str, Any]) -> dict[str, Any]:
    """Return an asset file's summary for other organisations, without values of columns that are or may be the owner's external ids."""
    if "columns" not in summary:
        return summary
    mappings = (summary.get("mapping", {}), summary.get("suggested_mapping", {}))
    private = {mapping.get("columns", {}).get("external_id") for mapping in mappings}
    columns = [
        column | {"samples": [], "values": None, "is_withheld": True} if column["name"] in private else column
        for column in summary["columns"]
    ]
    features = [
        feature | {"properties": {name: value for name, value in feature["properties"].items() if name not in private}}
        for feature in summary["preview"]["features"]
    ]
    return summary | {"columns": columns, "preview": summary["preview"] | {"features": features}}


def change_feature(change: DrawnChange) -> dict[str, Any]:
    return {
        "type": "Feature",
        "id": change.pk,
        "geometry": json.loads(change.geometry_json) if change.geometry_json else None,
        "properties": {
            "action": change.action,
            "subject": change.subject,
            "subject_id": change.subject_id,
            "label": change.label,
            "key": change.key,
            "before": change.before,
            "after": change.after,
        },
    }
