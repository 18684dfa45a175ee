"""Zone sets, their versions and subscriptions. They state facts without an assessment: the source's data, and when it was fetched."""

from typing import Any

from inspection.models import DataImport, ImportProposal, ProposalState, ZoneSetVersion, ZoneSubscription
from inspection.selectors.zone_sets import CountedZoneSet
from inspection.serializers.features import SourceSerializer, source_json
from inspection.services.imports.zones import FORMAT_NAMES
from workspace.admin_pages.author_names import AUTHOR_HELP, author_name
from workspace.api import strict_serializers as serializers
from workspace.http_client import OutgoingRefused, check_address
from workspace.jobs.serializers import Declared
from workspace.models import User

MAX_INTERVAL_H = 24 * 90


class ZoneSetSourceSerializer(SourceSerializer):
    """The file that the set last imported."""

    imported_by = serializers.CharField(allow_null=True, help_text=AUTHOR_HELP)


class SubscriptionProposalSerializer(serializers.Serializer):
    """The last new file from the source."""

    id = serializers.UUIDField()
    state = serializers.ChoiceField(choices=ProposalState.choices)
    difference = serializers.DictField(help_text="numbers of changes by action; empty until it is read")


class ZoneSubscriptionSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    zone_set = serializers.IntegerField()
    set_name = serializers.CharField()
    address = serializers.CharField()
    source_format = serializers.CharField(help_text="empty: found out from the file")
    licence = serializers.CharField()
    attribution = serializers.CharField()
    interval_h = serializers.IntegerField()
    is_active = serializers.BooleanField()
    next_fetch_at = serializers.DateTimeField()
    fetched_at = serializers.DateTimeField(allow_null=True, help_text="when the source last answered, also that nothing is new")
    problem = serializers.CharField(help_text="why the last fetch brought nothing; empty = it did")
    failures = serializers.IntegerField(help_text="one after the other")
    proposal = SubscriptionProposalSerializer(allow_null=True)


class ZoneSetSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    name = serializers.CharField()
    source_format = serializers.CharField()
    zone_count = serializers.IntegerField(help_text="each layer of a zone counts")
    edited_count = serializers.IntegerField(help_text="zones that a curator changed by hand")
    version_count = serializers.IntegerField()
    source: Declared = ZoneSetSourceSerializer(allow_null=True)
    subscription = ZoneSubscriptionSerializer(allow_null=True)


class ZoneSetPageSerializer(serializers.Serializer):
    results = ZoneSetSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="address of the next page")


class ZoneSetVersionSerializer(serializers.Serializer):
    version = serializers.IntegerField()
    zone_count = serializers.IntegerField()
    created_at = serializers.DateTimeField()
    created_by = serializers.CharField(allow_null=True, help_text=AUTHOR_HELP)
    source: Declared = ZoneSetSourceSerializer(allow_null=True)


class ZoneSetVersionPageSerializer(serializers.Serializer):
    results = ZoneSetVersionSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="address of the next page")


class RollBackSerializer(serializers.Serializer):
    version = serializers.IntegerField(min_value=1, max_value=2**31 - 1)


class ZoneSubscriptionPageSerializer(serializers.Serializer):
    results = ZoneSubscriptionSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="address of the next page")


class SubscriptionChangeSerializer(serializers.Serializer):
    address = serializers.CharField(max_length=500, help_text="http or https, on the public internet, without user name or password")
    source_format = serializers.ChoiceField(choices=list(FORMAT_NAMES), allow_blank=True, required=False)
    licence = serializers.CharField(max_length=200, allow_blank=True, required=False)
    attribution = serializers.CharField(max_length=300, allow_blank=True, required=False)
    interval_h = serializers.IntegerField(min_value=1, max_value=MAX_INTERVAL_H, required=False)
    is_active = serializers.BooleanField(required=False)

    def validate_address(self, address: str) -> str:
        try:
            check_address(address)
        except OutgoingRefused as error:
            raise serializers.ValidationError(str(error)) from error
        return address


class SubscriptionInputSerializer(SubscriptionChangeSerializer):
    set_name = serializers.CharField(max_length=200, help_text="of the set that is fetched; made if there is none")


class FetchJobSerializer(serializers.Serializer):
    """The fetch job; its result has `proposal`, the new one or null."""

    job = serializers.UUIDField()


def zone_set_json(zone_set: CountedZoneSet, reader: User) -> dict[str, Any]:
    return {
        "id": zone_set.pk,
        "name": zone_set.name,
        "source_format": zone_set.source_format,
        "zone_count": zone_set.zone_count,
        "edited_count": zone_set.edited_count,
        "version_count": zone_set.version_count,
        "source": _source_json(zone_set.data_import, reader),
        "subscription": subscription_json(zone_set.subscription) if hasattr(zone_set, "subscription") else None,
    }


def version_json(version: ZoneSetVersion, reader: User) -> dict[str, Any]:
    return {
        "version": version.number,
        "zone_count": version.zones,
        "created_at": version.created_at,
        "created_by": author_name(version.created_by, reader),
        "source": _source_json(version.data_import, reader),
    }


def subscription_json(subscription: ZoneSubscription) -> dict[str, Any]:
    names = (
        "id", "address", "source_format", "licence", "attribution", "interval_h", "is_active", "next_fetch_at", "fetched_at", "problem",
        "failures",
    )  # fmt: skip
    return {name: getattr(subscription, name) for name in names} | {
        "zone_set": subscription.zone_set_id,
        "set_name": subscription.zone_set.name,
        "proposal": _proposal_json(subscription.proposal),
    }


def _proposal_json(proposal: ImportProposal | None) -> dict[str, Any] | None:
    return {"id": str(proposal.pk), "state": proposal.state, "difference": proposal.difference} if proposal else None


def _source_json(data_import: DataImport | None, reader: User) -> dict[str, Any] | None:
    source = source_json(data_import)
    return source | {"imported_by": author_name(data_import.imported_by, reader)} if source and data_import else None
