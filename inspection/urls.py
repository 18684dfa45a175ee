"""Addresses of the ground under /api/v1/."""

from django.urls import path

from inspection.views import assets, gaps, geometry_checks, ground, history, imports, uploads, zone_sets, zones

urlpatterns = [
    path("assets", assets.AssetList.as_view(), name="api-assets"),
    path("assets/<int:asset_id>", assets.AssetDetail.as_view(), name="api-asset"),
    path("assets/<int:asset_id>/history", history.AssetHistory.as_view(), name="api-asset-history"),
    path("assets/<int:asset_id>/revert", history.AssetRevert.as_view(), name="api-asset-revert"),
    path("assets/<int:asset_id>/follow-source", history.AssetFollowSource.as_view(), name="api-asset-follow-source"),
    path("zones", zones.ZoneList.as_view(), name="api-zones"),
    path("zones/<int:zone_id>", zones.ZoneDetail.as_view(), name="api-zone"),
    path("zones/<int:zone_id>/history", history.ZoneHistory.as_view(), name="api-zone-history"),
    path("zones/<int:zone_id>/revert", history.ZoneRevert.as_view(), name="api-zone-revert"),
    path("zone-sets", zone_sets.ZoneSetList.as_view(), name="api-zone-sets"),
    path("zone-sets/<int:set_id>", zone_sets.ZoneSetDetail.as_view(), name="api-zone-set"),
    path("zone-sets/<int:set_id>/versions", zone_sets.ZoneSetVersions.as_view(), name="api-zone-set-versions"),
    path("zone-sets/<int:set_id>/roll-back", zone_sets.ZoneSetRollBack.as_view(), name="api-zone-set-roll-back"),
    path("zone-subscriptions", zone_sets.ZoneSubscriptionList.as_view(), name="api-zone-subscriptions"),
    path("zone-subscriptions/<int:subscription_id>", zone_sets.ZoneSubscriptionDetail.as_view(), name="api-zone-subscription"),
    path("zone-subscriptions/<int:subscription_id>/fetch", zone_sets.ZoneSubscriptionFetch.as_view(), name="api-zone-subscription-fetch"),
    path("history", history.HistoryList.as_view(), name="api-history"),
    path("history/<int:entry_id>/undo", history.HistoryUndo.as_view(), name="api-undo"),
    path("uploads", uploads.UploadList.as_view(), name="api-uploads"),
    path("uploads/<uuid:upload_id>", uploads.UploadDetail.as_view(), name="api-upload"),
    path("uploads/<uuid:upload_id>/bytes/<int:first_byte>", uploads.UploadBytes.as_view(), name="api-upload-bytes"),
    path("imports", imports.ImportList.as_view(), name="api-imports"),
    path("imports/<uuid:proposal_id>", imports.ImportDetail.as_view(), name="api-import"),
    path("imports/<uuid:proposal_id>/changes", imports.ImportChanges.as_view(), name="api-import-changes"),
    path("imports/<uuid:proposal_id>/apply", imports.ImportApply.as_view(), name="api-import-apply"),
    path("imports/<uuid:proposal_id>/discard", imports.ImportDiscard.as_view(), name="api-import-discard"),
    path("geometry-checks", geometry_checks.GeometryCheck.as_view(), name="api-geometry-checks"),
    path("gaps", gaps.GapList.as_view(), name="api-gaps"),
    path("gaps/summary", gaps.GapCounts.as_view(), name="api-gap-summary"),
    path("gaps/<int:gap_id>", gaps.GapDetail.as_view(), name="api-gap"),
    path("gaps/<int:gap_id>/repair", gaps.GapRepair.as_view(), name="api-gap-repair"),
    path("gaps/<int:gap_id>/undo", gaps.GapUndo.as_view(), name="api-gap-undo"),
    path("gaps/<int:gap_id>/dismiss", gaps.GapDismiss.as_view(), name="api-gap-dismiss"),
    path("gaps/<int:gap_id>/reopen", gaps.GapReopen.as_view(), name="api-gap-reopen"),
    path("ground", ground.Ground.as_view(), name="api-ground"),
    path("tiles/<int:zoom>/<int:column>/<int:row>", ground.Tile.as_view(), name="api-tile"),
]
