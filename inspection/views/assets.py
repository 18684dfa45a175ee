"""Assets: the list and one of them."""

from django.http import Http404
from django.urls import reverse
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
    asset_feature,
)
from inspection.serializers.edits import AssetInputSerializer
from inspection.services import delete_asset, save_asset
from inspection.views.edits import edits
from inspection.views.history import answer, asset_now
from inspection.views.parameters import BOX, box_of, kinds_of, text_of
from workspace.idempotency import idempotent
from workspace.paging import changed_since, page_of
from workspace.permissions import CURATORS
from workspace.preconditions import IF_MATCH_REQUIRED, PRECONDITION_ANSWERS, expected_revision
from workspace.schema import CHANGED_SINCE, PAGE_PARAMETERS
from workspace.signed_in import SignedInRequest


class AssetList(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="list_assets",
        summary="Assets: towers, lines, railways, bridges",
        parameters=[
            BOX,
            OpenApiParameter("kind", str, description=f"one or several of {', '.join(AssetKind.values)}, with commas"),
            OpenApiParameter("text", str, description='words in name, ref or operator; "138 kV"; an OSM id such as w123; best first'),
            OpenApiParameter("flyable", bool, description="true: only what may be flown to"),
            OpenApiParameter("total", bool, description="true: also how many there are, on all pages"),
            CHANGED_SINCE,
            *PAGE_PARAMETERS,
        ],
        responses=AssetCollectionSerializer,
    )
    def get(self, request: Request) -> Response:
        text = text_of(request)
        flyable = True if request.query_params.get("flyable") == "true" else None
        found = selectors.assets_on_the_ground(box=box_of(request), kinds=kinds_of(request), text=text, flyable=flyable)
        found = changed_since(request, found)
        assets = found.only(*FIELDS_OF_AN_ASSET)
        page = page_of(request, with_match_rank(assets, text=text), order=BEST_FIRST) if text else page_of(request, assets)
        features = [asset_feature(asset) for asset in page.rows]
        total = {"total": found.count()} if request.query_params.get("total") == "true" else {}
        return Response({"type": "FeatureCollection", "features": features, "next": page.next} | total)

    @extend_schema(
        operation_id="create_asset", summary="Draw an asset", request=AssetInputSerializer, responses={201: AssetDetailFeatureSerializer}
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        body = AssetInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        with edits(lambda: None):
            asset = save_asset(asset=Asset(**body.validated_data), actor=request.user)
        response = answer(asset_now(asset.pk))
        response.status_code = 201
        response["Location"] = reverse("api-asset", args=[asset.pk])
        return response


class AssetDetail(APIView):
    write_roles = CURATORS

    @extend_schema(operation_id="get_asset", summary="One asset with its tags and source", responses=AssetDetailFeatureSerializer)
    def get(self, request: Request, asset_id: int) -> Response:
        return answer(asset_now(asset_id))

    @extend_schema(
        operation_id="change_asset",
        summary="Correct an asset",
        description="Imports leave what was corrected by hand alone.",
        parameters=[IF_MATCH_REQUIRED],
        request=AssetInputSerializer(partial=True),
        responses={200: AssetDetailFeatureSerializer} | PRECONDITION_ANSWERS,
    )
    def patch(self, request: SignedInRequest, asset_id: int) -> Response:
        revision = expected_revision(request)
        asset = self._asset(asset_id)
        body = AssetInputSerializer(asset, data=request.data, partial=True)
        body.is_valid(raise_exception=True)
        for name, value in body.validated_data.items():
            setattr(asset, name, value)
        with edits(lambda: asset_now(asset_id)):
            save_asset(asset=asset, actor=request.user, expected_revision=revision)
        return answer(asset_now(asset_id))

    @extend_schema(
        operation_id="delete_asset",
        summary="Take an asset off the ground",
        description="Its history can bring it back. What came from a file is kept as vanished, so that the next import leaves it away.",
        parameters=[IF_MATCH_REQUIRED],
        responses={204: None} | PRECONDITION_ANSWERS,
    )
    def delete(self, request: SignedInRequest, asset_id: int) -> Response:
        revision = expected_revision(request)
        with edits(lambda: asset_now(asset_id)):
            delete_asset(asset=self._asset(asset_id), actor=request.user, expected_revision=revision)
        return Response(status=204)

    def _asset(self, asset_id: int) -> Asset:
        try:
            return Asset.objects.get(pk=asset_id)
        except Asset.DoesNotExist as error:
            raise Http404 from error
