"""URLs of the map data pages."""

from django.urls import path

from inspection.pages import AssetsPage, DataIssuesPage, ImportsPage, TerrainPage, ZonesPage

urlpatterns = [
    path("assets", AssetsPage.as_view(), name="assets"),
    path("assets/data-issues", DataIssuesPage.as_view(), name="data-issues"),
    path("imports", ImportsPage.as_view(), name="imports"),
    path("imports/<uuid:proposal_id>", ImportsPage.as_view(), name="import"),
    path("terrain", TerrainPage.as_view(), name="terrain"),
    path("zones", ZonesPage.as_view(), name="zones"),
]
