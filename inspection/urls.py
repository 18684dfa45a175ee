"""Addresses of the ground under /api/v1/."""

from django.urls import path

from inspection.views import assets, ground, zones

urlpatterns = [
    path("assets", assets.AssetList.as_view(), name="api-assets"),
    path("assets/<int:asset_id>", assets.AssetDetail.as_view(), name="api-asset"),
    path("zones", zones.ZoneList.as_view(), name="api-zones"),
    path("zones/<int:zone_id>", zones.ZoneDetail.as_view(), name="api-zone"),
    path("ground", ground.Ground.as_view(), name="api-ground"),
    path("tiles/<int:zoom>/<int:column>/<int:row>", ground.Tile.as_view(), name="api-tile"),
]
