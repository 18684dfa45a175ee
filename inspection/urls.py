"""Addresses of the ground under /api/v1/."""

from django.urls import path

from inspection import views

urlpatterns = [
    path("assets", views.AssetList.as_view(), name="api-assets"),
    path("assets/<int:asset_id>", views.AssetDetail.as_view(), name="api-asset"),
    path("zones", views.ZoneList.as_view(), name="api-zones"),
    path("zones/<int:zone_id>", views.ZoneDetail.as_view(), name="api-zone"),
    path("ground", views.Ground.as_view(), name="api-ground"),
    path("tiles/<int:zoom>/<int:column>/<int:row>", views.Tile.as_view(), name="api-tile"),
]
