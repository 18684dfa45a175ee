"""The history of map data: reading it, and undoing changes."""

from typing import Any

from django.http import Http404
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, PolymorphicProxySerializer, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import Asset, NoFlyZone
from inspection.selectors.history import NEWEST_FIRST, SUBJECTS, changes_by, changes_of, changes_of_the_ground
from inspection.serializers.assets import AssetDetailFeatureSerializer
from inspection.serializers.zones import ZoneDetailFeatureSerializer
from inspection.services.facts import differing
from inspection.services.history import follow_source, revert_asset, revert_zone, undo
from inspection.views.edits import answer, asset_now, edits, zone_now
from inspection.views.parameters import invalid
from workspace.admin_pages.author_names import AUTHOR_HELP, author_name
from workspace.api import strict_serializers as serializers
from workspace.api.paging import asked_choice, page_of
from workspace.api.permissions import CURATORS
from workspace.api.preconditions import IF_MATCH_REQUIRED, PRECONDITION_ANSWERS, expected_revision
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.models import AuditEntry, User

OF_THE_SOURCE = {"node_osm_ids", "parts", "content_hash", "data_import_id", "asset_set_id", "zone_set_id", "source_heights", "properties"}
UNDONE = PolymorphicProxySerializer(
    component_name="UndoneFeature", serializers=[AssetDetailFeatureSerializer, ZoneDetailFeatureSerializer], resource_type_field_name=None
)
CANNOT = {409: OpenApiResponse(description="It was changed again since, or there is nothing to go back to.")}


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
    before, after = differing(_for_users(entry.before), _for_users(entry.after))
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


def _for_users(facts: dict[str, Any] | None) -> dict[str, Any] | None:
    return facts and {name: value for name, value in facts.items() if name not in OF_THE_SOURCE}


def _entry(subject_type: str, subject_id: int, request: Request) -> AuditEntry:
    body = RevertSerializer(data=request.data)
    body.is_valid(raise_exception=True)
    entry = changes_of(subject_type, subject_id).filter(pk=body.validated_data["entry"]).first()
    if entry is None:
        raise invalid("entry", _("This is no entry of its history."))
    return entry


def _page(request: SignedInRequest, entries: Any) -> dict[str, Any]:
    page = page_of(request, entries, order=NEWEST_FIRST, default_limit=50)
    return {"results": [entry_json(entry, request.user) for entry in page.rows], "next": page.next}


class HistoryList(APIView):
    @extend_schema(
        operation_id="list_history",
        summary="What was changed on the ground, newest first",
        parameters=[
            OpenApiParameter("subject_type", str, enum=SUBJECTS),
            OpenApiParameter("actor", str, description="a user name of your organisation"),
            *PAGE_PARAMETERS,
        ],
        responses=GroundHistoryPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        subject_type = asked_choice(request, "subject_type", SUBJECTS)
        actor = request.query_params.get("actor", "")
        if not actor.isprintable():
            raise invalid("actor", _("A user name is printable."))
        entries = changes_of_the_ground(subject_type=subject_type)
        return Response(_page(request, changes_by(actor, entries, reader=request.user) if actor else entries))


class HistoryUndo(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="undo_change",
        summary="Take the newest change of an asset or zone back",
        description="What was deleted is there again under its old id, what was created is gone. The taking back is a change too.",
        request=None,
        responses={200: UNDONE, 204: OpenApiResponse(description="What was created is gone.")} | CANNOT,
    )
    def post(self, request: SignedInRequest, entry_id: int) -> Response:
        entry = changes_of_the_ground().filter(pk=entry_id).first()
        if entry is None:
            raise Http404

        def now(key: int) -> dict[str, Any] | None:
            return asset_now(request.user, key) if entry.subject_type == "asset" else zone_now(request.user, key)

        with edits(request.user, lambda: now(int(entry.subject_id))):
            row = undo(entry=entry, actor=request.user)
        return Response(status=204) if row is None else answer(now(row.pk))


class AssetHistory(APIView):
    @extend_schema(
        operation_id="list_asset_history",
        summary="The history of an asset",
        parameters=PAGE_PARAMETERS,
        responses=GroundHistoryPageSerializer,
    )
    def get(self, request: SignedInRequest, asset_id: int) -> Response:
        page = _page(request, changes_of("asset", asset_id))
        asset = Asset.objects.select_related("data_import").filter(pk=asset_id).first()
        if asset is None and not page["results"]:
            raise Http404
        if asset is not None and page["next"] is None and not any(entry["action"] == "created" for entry in page["results"]):
            page["results"].append(_first_import(asset))
        return Response(page)


def _first_import(asset: Asset) -> dict[str, Any]:
    return {
        "id": None, "action": "imported", "actor": None, "recorded_at": asset.created_at, "subject_type": "asset",
        "subject_id": str(asset.pk), "before": None, "after": None, "file_name": asset.data_import and asset.data_import.file_name,
    }  # fmt: skip


class AssetRevert(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="revert_asset",
        summary="Bring an asset back to what it was before a change",
        parameters=[IF_MATCH_REQUIRED],
        request=RevertSerializer,
        responses={200: AssetDetailFeatureSerializer} | PRECONDITION_ANSWERS | CANNOT,
    )
    def post(self, request: SignedInRequest, asset_id: int) -> Response:
        entry, revision = _entry("asset", asset_id, request), expected_revision(request)
        asset = _asset(asset_id)
        with edits(request.user, lambda: asset_now(request.user, asset_id)):
            revert_asset(asset=asset, entry=entry, actor=request.user, expected_revision=revision)
        return answer(asset_now(request.user, asset_id))


class AssetFollowSource(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="follow_source",
        summary="Forget what was edited by hand and follow the source again",
        parameters=[IF_MATCH_REQUIRED],
        request=None,
        responses={200: AssetDetailFeatureSerializer} | PRECONDITION_ANSWERS | CANNOT,
    )
    def post(self, request: SignedInRequest, asset_id: int) -> Response:
        revision = expected_revision(request)
        asset = _asset(asset_id)
        with edits(request.user, lambda: asset_now(request.user, asset_id)):
            follow_source(asset=asset, actor=request.user, expected_revision=revision)
        return answer(asset_now(request.user, asset_id))


class ZoneHistory(APIView):
    @extend_schema(
        operation_id="list_zone_history", summary="The history of a zone", parameters=PAGE_PARAMETERS, responses=GroundHistoryPageSerializer
    )
    def get(self, request: SignedInRequest, zone_id: int) -> Response:
        page = _page(request, changes_of("zone", zone_id))
        if not page["results"] and not NoFlyZone.objects.filter(pk=zone_id).exists():
            raise Http404
        return Response(page)


class ZoneRevert(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="revert_zone",
        summary="Bring a zone back to what it was before a change",
        parameters=[IF_MATCH_REQUIRED],
        request=RevertSerializer,
        responses={200: ZoneDetailFeatureSerializer} | PRECONDITION_ANSWERS | CANNOT,
    )
    def post(self, request: SignedInRequest, zone_id: int) -> Response:
        entry, revision = _entry("zone", zone_id, request), expected_revision(request)
        zone = NoFlyZone.objects.filter(pk=zone_id).first()
        if zone is None:
            raise Http404
        with edits(request.user, lambda: zone_now(request.user, zone_id)):
            revert_zone(zone=zone, entry=entry, actor=request.user, expected_revision=revision)
        return answer(zone_now(request.user, zone_id))


def _asset(asset_id: int) -> Asset:
    asset = Asset.objects.filter(pk=asset_id).first()
    if asset is None:
        raise Http404
    return asset
