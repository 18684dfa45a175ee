"""Assets: the list and one of them."""

from typing import Any

from django.db.models import Case, IntegerField, Q, QuerySet, Value, When
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection import selectors
from inspection.models import Asset, AssetKind
from inspection.selectors.assets import DrawnAsset
from inspection.selectors.register.assets import assets_in_order, assets_that_match, last_inspections
from inspection.serializers.assets import (
    FIELDS_OF_AN_ASSET,
    AssetCollectionSerializer,
    AssetDetailFeatureSerializer,
    asset_feature,
)
from inspection.serializers.edits import AssetInputSerializer
from inspection.services import delete_asset, save_asset
from inspection.services.curation import REFERENCE_FIELDS, save_asset_reference
from inspection.views.edits import Curated, answer, asset_now, with_values
from inspection.views.register_filters import ASSET_FILTERS, ASSET_SORT, ASSET_SORTS, asset_filter
from workspace.api.idempotency import idempotent
from workspace.api.paging import asked_choice, asked_flag, changed_since, page_of
from workspace.api.permissions import CURATORS
from workspace.api.preconditions import IF_MATCH_REQUIRED, PRECONDITION_ANSWERS
from workspace.api.schema import CHANGED_SINCE, PAGE_PARAMETERS, request_example
from workspace.api.signed_in import SignedInRequest
from workspace.models import User

BEST_FIRST = ("match_rank", "pk")
TOWER_EXAMPLE = {"kind": "tower", "ref": "T 17", "height_m": 42, "geometry": {"type": "Point", "coordinates": [9.52, 47.14]}}
EXTERNAL_ID_TAKEN = {409: OpenApiResponse(description="Another asset has the external id.")}


def with_match_rank(assets: QuerySet[DrawnAsset], *, text: str) -> QuerySet[DrawnAsset]:
    """Annotate assets with `match_rank`: 0 and 1 are named exactly `text`, 2 and 3 match otherwise; supports have odd ranks."""
    is_exact = Q(ref__iexact=text) | Q(name__iexact=text)
    is_support = Q(kind=AssetKind.TOWER)
    rank = Case(
        When(is_exact & ~is_support, then=Value(0)),
        When(is_exact, then=Value(1)),
        When(~is_support, then=Value(2)),
        default=Value(3),
        output_field=IntegerField(),
    )
    return assets.annotate(match_rank=rank)


class AssetList(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="list_assets",
        summary="Assets: towers, lines, railways, bridges",
        parameters=[
            *ASSET_FILTERS,
            ASSET_SORT,
            OpenApiParameter("total", bool, description="true: also how many there are, on all pages"),
            CHANGED_SINCE,
            *PAGE_PARAMETERS,
        ],
        responses=AssetCollectionSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        wanted, organisation = asset_filter(request), request.user.organisation_id
        found = changed_since(request, assets_that_match(wanted))
        assets = found.only(*FIELDS_OF_AN_ASSET)
        order: tuple[str, ...] = ("pk",)
        if sort := asked_choice(request, "sort", ASSET_SORTS):
            assets, order = assets_in_order(assets, sort, organisation)
        elif wanted.text:
            assets, order = with_match_rank(assets, text=wanted.text), BEST_FIRST
        page = page_of(request, assets, order=order)
        keys = [asset.pk for asset in page.rows]
        references, inspected = selectors.references_of(organisation, keys), last_inspections(organisation, keys)
        features = [asset_feature(asset, references.get(asset.pk), inspected.get(asset.pk)) for asset in page.rows]
        total = {"total": found.count()} if asked_flag(request, "total") else {}
        return Response({"type": "FeatureCollection", "features": features, "next": page.next} | total)

    @extend_schema(
        operation_id="create_asset",
        summary="Draw an asset",
        request=AssetInputSerializer,
        responses={201: AssetDetailFeatureSerializer} | EXTERNAL_ID_TAKEN,
        examples=[request_example(TOWER_EXAMPLE)],
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        return ASSETS.drawn(request)


def _save(asset: Asset, values: dict[str, Any], *, actor: User, expected_revision: int | None) -> Asset:
    """Store the facts of the asset, and the organisation's reference beside it."""
    reference = {name: values.pop(name) for name in REFERENCE_FIELDS if name in values}
    is_new = asset.pk is None
    if values or not reference:
        save_asset(asset=with_values(asset, values), actor=actor, expected_revision=expected_revision)
    if any(reference.values()) if is_new else reference:
        unseen = None if values else expected_revision
        save_asset_reference(asset=asset, actor=actor, values=reference, expected_revision=unseen)
    return asset


ASSETS = Curated(
    Asset, AssetInputSerializer, "api-asset", asset_now, save=_save, delete=lambda asset, **by: delete_asset(asset=asset, **by)
)


class AssetDetail(APIView):
    write_roles = CURATORS

    @extend_schema(operation_id="get_asset", summary="One asset with its tags and source", responses=AssetDetailFeatureSerializer)
    def get(self, request: SignedInRequest, asset_id: int) -> Response:
        return answer(asset_now(request.user, asset_id))

    @extend_schema(
        operation_id="change_asset",
        summary="Correct an asset",
        description=(
            "Imports leave what was corrected by hand alone. `external_id` and `attributes` are your organisation's: they survive imports, "
            "and setting them alone is no correction."
        ),
        parameters=[IF_MATCH_REQUIRED],
        request=AssetInputSerializer(partial=True),
        responses={200: AssetDetailFeatureSerializer} | PRECONDITION_ANSWERS | EXTERNAL_ID_TAKEN,
    )
    def patch(self, request: SignedInRequest, asset_id: int) -> Response:
        return ASSETS.corrected(request, asset_id)

    @extend_schema(
        operation_id="delete_asset",
        summary="Delete an asset",
        description="Its history can bring it back. An asset from a file is kept as vanished, so that the next import leaves it out.",
        parameters=[IF_MATCH_REQUIRED],
        responses={204: None} | PRECONDITION_ANSWERS,
    )
    def delete(self, request: SignedInRequest, asset_id: int) -> Response:
        return ASSETS.removed(request, asset_id)
