"""Assets: the list and one of them."""

from django.http import Http404
from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection import selectors
from inspection.models import Asset, AssetKind
from inspection.selectors.asset_search import BEST_FIRST, with_match_rank
from inspection.serializers.assets import (
    FIELDS_OF_AN_ASSET,
    AssetCollectionSerializer,
    AssetDetailFeatureSerializer,
    asset_detail_feature,
    asset_feature,
)
from inspection.views.parameters import BOX, box_of, kinds_of, text_of
from workspace.paging import page_of
from workspace.schema import PAGE_PARAMETERS


class AssetList(APIView):
    @extend_schema(
        operation_id="list_assets",
        summary="Assets: towers, lines, railways, bridges",
        parameters=[
            BOX,
            OpenApiParameter("kind", str, description=f"one or several of {', '.join(AssetKind.values)}, with commas"),
            OpenApiParameter("text", str, description='words in name, ref or operator; "138 kV"; an OSM id such as w123; best first'),
            *PAGE_PARAMETERS,
        ],
        responses=AssetCollectionSerializer,
    )
    def get(self, request: Request) -> Response:
        text = text_of(request)
        assets = selectors.assets_on_the_ground(box=box_of(request), kinds=kinds_of(request), text=text).only(*FIELDS_OF_AN_ASSET)
        page = page_of(request, with_match_rank(assets, text=text), order=BEST_FIRST) if text else page_of(request, assets)
        features = [asset_feature(asset) for asset in page.rows]
        return Response({"type": "FeatureCollection", "features": features, "next": page.next})


class AssetDetail(APIView):
    @extend_schema(operation_id="get_asset", summary="One asset with its tags and source", responses=AssetDetailFeatureSerializer)
    def get(self, request: Request, asset_id: int) -> Response:
        try:
            return Response(asset_detail_feature(selectors.asset_with_geometry(asset_id)))
        except Asset.DoesNotExist as error:
            raise Http404 from error
