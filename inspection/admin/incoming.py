"""Admin pages for incoming data and results: uploads, proposals, imports, sets of assets, terrain, graphs, issues."""

from typing import Any

from django.contrib import admin
from django.db.models import Count, QuerySet
from django.http import HttpRequest
from django.urls import reverse
from django.utils.html import format_html
from django.utils.safestring import SafeString

from inspection.admin.curated import CommonGroundAdmin
from inspection.models import (
    AssetSet,
    DataImport,
    DataIssue,
    DataIssueState,
    GraphSnapshot,
    Ground,
    ImportProposal,
    TerrainTile,
    Upload,
)
from inspection.services.data_issues import dismiss_issue, reopen_issue
from workspace.api.signed_in import user_of


@admin.register(ImportProposal)
class ImportProposalAdmin(CommonGroundAdmin):
    """Proposals; the imports page, to which each row links, shows, applies and discards them."""

    list_display = ["file", "page", "kind", "origin", "state", "new", "changed", "vanished", "created_by", "created_at", "decided_by"]
    list_filter = ["state", "kind", "origin"]
    list_select_related = ["created_by", "decided_by"]
    search_fields = ["file_name", "created_by__username"]
    date_hierarchy = "created_at"
    fields = [
        "page", "kind", "origin", "state", "file_name", "parameters", "provenance", "faults", "difference", "ground_revision",
        "auto_apply", "max_removed_percent", "held_back", "data_import", "created_by", "created_at", "decided_by", "decided_at",
    ]  # fmt: skip

    def get_queryset(self, request: HttpRequest) -> QuerySet[ImportProposal]:
        return super().get_queryset(request).defer("summary")

    @admin.display(description="file", ordering="file_name")
    def file(self, proposal: ImportProposal) -> str:
        return proposal.file_name or proposal.get_origin_display()

    @admin.display(description="new")
    def new(self, proposal: ImportProposal) -> Any:
        return proposal.difference.get("new")

    @admin.display(description="changed")
    def changed(self, proposal: ImportProposal) -> Any:
        return proposal.difference.get("changed")

    @admin.display(description="vanished")
    def vanished(self, proposal: ImportProposal) -> Any:
        return proposal.difference.get("vanished")

    @admin.display(description="on the map")
    def page(self, proposal: ImportProposal) -> SafeString:
        return format_html('<a href="{}">Open</a>', reverse("import", args=[proposal.pk]))


@admin.register(Upload)
class UploadAdmin(CommonGroundAdmin):
    list_display = ["file_name", "size_bytes", "received_bytes", "whole", "created_by", "created_at"]
    list_select_related = ["created_by"]
    search_fields = ["file_name", "created_by__username"]

    @admin.display(boolean=True)
    def whole(self, upload: Upload) -> bool:
        return upload.is_complete


@admin.register(AssetSet)
class AssetSetAdmin(CommonGroundAdmin):
    list_display = ["name", "number_of_assets", "data_import"]
    list_select_related = ["data_import"]
    search_fields = ["name"]

    def get_queryset(self, request: HttpRequest) -> QuerySet[AssetSet]:
        return super().get_queryset(request).annotate(number_of_assets=Count("assets"))

    @admin.display(description="assets", ordering="number_of_assets")
    def number_of_assets(self, asset_set: Any) -> int:
        return int(asset_set.number_of_assets)


@admin.register(DataIssue)
class DataIssueAdmin(CommonGroundAdmin):
    """Data issues, repaired on the issues page; here several are dismissed or reopened at once."""

    list_display = ["kind", "asset", "cut_off_m", "state", "note", "decided_by", "decided_at", "found_at"]
    list_filter = ["state", "kind"]
    list_select_related = ["asset", "decided_by"]
    search_fields = ["key", "note", "asset__name", "asset__ref"]
    actions = ["dismiss", "reopen"]
    fields = [
        "kind",
        "state",
        "asset",
        "other_asset",
        "details",
        "cut_off_m",
        "ground_revision",
        "note",
        "decided_by",
        "decided_at",
        "found_at",
    ]

    @admin.action(description="Leave the chosen as they are", permissions=["view"])
    def dismiss(self, request: HttpRequest, queryset: QuerySet[DataIssue]) -> None:
        chosen = list(queryset.filter(state=DataIssueState.OPEN))
        for issue in chosen:
            dismiss_issue(issue=issue, note="", actor=user_of(request))
        self.message_user(request, f"{len(chosen)} left as they are.")

    @admin.action(description="Open the chosen again", permissions=["view"])
    def reopen(self, request: HttpRequest, queryset: QuerySet[DataIssue]) -> None:
        chosen = list(queryset.exclude(state=DataIssueState.OPEN))
        for issue in chosen:
            reopen_issue(issue=issue, actor=user_of(request))
        self.message_user(request, f"{len(chosen)} opened again.")


@admin.register(DataImport)
class DataImportAdmin(CommonGroundAdmin):
    list_display = ["file_name", "kind", "is_synthetic", "data_timestamp", "imported_at", "imported_by", "attribution", "licence"]
    list_filter = ["kind", "is_synthetic"]
    list_select_related = ["imported_by"]
    search_fields = ["file_name", "sha256"]
    date_hierarchy = "imported_at"


@admin.register(TerrainTile)
class TerrainTileAdmin(CommonGroundAdmin):
    list_display = ["__str__", "columns", "rows", "step_lon_deg", "step_lat_deg", "vertical_datum"]
    list_select_related = ["data_import"]
    exclude = ["heights_amsl_m", "extent"]

    def get_queryset(self, request: HttpRequest) -> QuerySet[TerrainTile]:
        return super().get_queryset(request).defer("heights_amsl_m")


@admin.register(GraphSnapshot)
class GraphSnapshotAdmin(CommonGroundAdmin):
    list_display = ["version", "ground_revision", "nodes", "edges", "components", "excluded_nodes", "excluded_edges", "build_s", "built_at"]
    exclude = ["arrays"]

    def get_queryset(self, request: HttpRequest) -> QuerySet[GraphSnapshot]:
        return super().get_queryset(request).defer("arrays")


@admin.register(Ground)
class GroundAdmin(CommonGroundAdmin):
    list_display = ["revision", "changed_at"]
