"""The history of assets and zones: who changed what, from what to what."""

from typing import Any

from inspection.services.facts import differing
from workspace import strict_serializers as serializers
from workspace.author_names import AUTHOR_HELP, author_name
from workspace.models import AuditEntry, User

OF_THE_SOURCE = {"node_osm_ids", "parts", "content_hash", "data_import_id", "asset_set_id", "zone_set_id", "source_heights", "properties"}


class GroundHistoryEntrySerializer(serializers.Serializer):
    id = serializers.IntegerField(allow_null=True, help_text="null for the first import, which cannot be undone by itself")
    action = serializers.CharField(help_text="created, changed, deleted, vanished, reverted, restored, followed source, imported")
    actor = serializers.CharField(allow_null=True, help_text=f"{AUTHOR_HELP}; null for a command or a person who is gone")
    recorded_at = serializers.DateTimeField()
    subject_type = serializers.ChoiceField(choices=["asset", "zone"])
    subject_id = serializers.CharField()
    before = serializers.DictField(allow_null=True, help_text="the facts that differ, as they were; null for something new")
    after = serializers.DictField(allow_null=True, help_text="the same facts afterwards; null for something deleted")
    file_name = serializers.CharField(allow_null=True, help_text="of the import that did it")


class GroundHistoryPageSerializer(serializers.Serializer):
    results = GroundHistoryEntrySerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="address of the next page")


class RevertSerializer(serializers.Serializer):
    entry = serializers.IntegerField(min_value=1, help_text="the state before this entry comes back")


def entry_json(entry: AuditEntry, reader: User) -> dict[str, Any]:
    before, after = differing(_for_people(entry.before), _for_people(entry.after))
    return {
        "id": entry.pk,
        "action": entry.action,
        "actor": author_name(entry.actor, reader),
        "recorded_at": entry.recorded_at,
        "subject_type": entry.subject_type,
        "subject_id": entry.subject_id,
        "before": before,
        "after": after,
        "file_name": None,
    }


def _for_people(facts: dict[str, Any] | None) -> dict[str, Any] | None:
    return facts and {name: value for name, value in facts.items() if name not in OF_THE_SOURCE}
