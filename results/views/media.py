"""Media: list, detail, placing by hand, review, and their files."""

from typing import Any
from uuid import UUID

from django.http import FileResponse, Http404
from django.shortcuts import get_object_or_404
from django.utils.translation import gettext as _
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import Asset
from inspection.selectors import asset_label
from inspection.views.parameters import invalid
from results.media_metadata.media_types import MEDIA_TYPES, name_with_suffix
from results.models import Medium, MediumKind, MediumState, Placement, Review
from results.selectors.media import NOT_REVIEWED, MediaFilter, media_of_organisation, media_that_match
from results.serializers import media as shapes
from results.services.media import IsEvidence, delete_medium, review_medium
from results.services.placing import assign_medium
from results.services.store import MediumMissing, derivative_name, open_stored, original_name
from results.services.uploads import known_media, media_use
from results.views.subjects import subject_of
from workspace.api.errors import ApiProblem
from workspace.api.paging import asked_choice, page_of
from workspace.api.permissions import EVERYBODY
from workspace.api.renderers import OneAnswer
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.api.whole_numbers import WholeNumber

TARGET = WholeNumber("target", "id of a target")
ASSET = WholeNumber("asset", "id of an asset; of a line, its supports' media are included")
UAV = WholeNumber("uav", "id of a UAV")
FILTERS = [
    OpenApiParameter("mission", UUID, description="id of a mission"),
    TARGET.documented,
    ASSET.documented,
    UAV.documented,
    OpenApiParameter("kind", str, enum=MediumKind.values),
    OpenApiParameter("state", str, enum=MediumState.values),
    OpenApiParameter("placement", str, enum=Placement.values),
    OpenApiParameter("review", str, enum=[NOT_REVIEWED, *Review.values], description="none: not reviewed yet"),
]
# A file of users is never run, whatever it holds: it is saved, not opened, and could load nothing if it were.
FILE_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Content-Security-Policy": "default-src 'none'; sandbox",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "private, max-age=31536000, immutable",  # a medium's bytes never change
}
FILE_TYPES: dict[Any, Any] = {(200, name): OpenApiTypes.BINARY for name in MEDIA_TYPES}


class MediaList(APIView):
    @extend_schema(
        operation_id="list_media",
        summary="Photos and videos, by the time they were taken",
        parameters=[*FILTERS, *PAGE_PARAMETERS],
        responses=shapes.MediumPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        media = media_that_match(request.user.organisation_id, _asked(request))
        page = page_of(request, media, order=("shown_at", "pk"))
        return Response({"results": media_json(page.rows), "next": page.next})


class MediaLookup(APIView):
    write_roles = EVERYBODY

    @extend_schema(
        operation_id="lookup_media",
        summary="Which of these files your organisation has",
        request=shapes.MediaLookupInputSerializer,
        responses=shapes.MediaLookupSerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        body = shapes.MediaLookupInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        known = known_media(request.user.organisation_id, body.validated_data["sha256"])
        found = [{"sha256": sha256, "id": str(medium.pk), "file_name": medium.file_name} for sha256, medium in sorted(known.items())]
        return Response({"known": found})


class MediaUsed(APIView):
    @extend_schema(operation_id="get_media_use", summary="How much room photos and videos take", responses=shapes.MediaUseSerializer)
    def get(self, request: SignedInRequest) -> Response:
        use = media_use(request.user.organisation_id)
        return Response({"used_bytes": use.used_bytes, "max_bytes": use.max_bytes})


class MediumDetail(APIView):
    @extend_schema(operation_id="get_medium", summary="One photo or video", responses=shapes.MediumSerializer)
    def get(self, request: SignedInRequest, medium_id: UUID) -> Response:
        return Response(media_json([medium_or_404(request, medium_id)])[0])

    @extend_schema(
        operation_id="change_medium",
        summary="Place a photo or video by hand, or state that you have looked at it",
        request=shapes.MediumChangeSerializer,
        responses=shapes.MediumSerializer,
    )
    def patch(self, request: SignedInRequest, medium_id: UUID) -> Response:
        medium = medium_or_404(request, medium_id)
        body = shapes.MediumChangeSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        values = body.validated_data
        if {"mission", "target", "asset"} & set(values):
            stated = {"mission": values.get("mission", None if values.get("target") else medium.mission_id)} | values
            subject = subject_of(request.user, stated)
            assign_medium(medium=medium, actor=request.user, mission=subject.mission, target=subject.target, asset=subject.asset)
        if "review" in values:
            review_medium(medium=medium, actor=request.user, review=values["review"])
        return Response(media_json([medium_or_404(request, medium_id)])[0])

    @extend_schema(
        operation_id="delete_medium",
        summary="Delete a photo or video",
        responses={204: None, 409: OpenApiResponse(description="`is_evidence`: a finding refers to it.")},
    )
    def delete(self, request: SignedInRequest, medium_id: UUID) -> Response:
        try:
            delete_medium(medium=medium_or_404(request, medium_id), actor=request.user)
        except IsEvidence as error:
            raise ApiProblem(409, "is_evidence", _("A finding refers to this photo: it cannot be deleted.")) from error
        return Response(status=204)


class MediumFile(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "media-files"

    @extend_schema(operation_id="download_medium", summary="A photo or video as it was sent", responses=FILE_TYPES)
    def get(self, request: SignedInRequest, medium_id: UUID) -> FileResponse:
        medium = medium_or_404(request, medium_id)
        name = name_with_suffix(medium.file_name, MEDIA_TYPES[medium.media_type])
        return _file(original_name(medium.organisation_id, medium.sha256), medium.media_type, name)


class MediumPreview(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "media-files"

    @extend_schema(
        operation_id="get_medium_preview",
        summary="A photo as a smaller WebP picture without metadata",
        parameters=[OpenApiParameter("edge", int, OpenApiParameter.PATH, description="longest edge in pixels: 400 or 1600")],
        responses={(200, "image/webp"): OpenApiTypes.BINARY},
    )
    def get(self, request: SignedInRequest, medium_id: UUID, edge: int) -> FileResponse:
        medium = medium_or_404(request, medium_id)
        if str(edge) not in medium.derivatives:
            raise Http404
        return _file(derivative_name(medium.organisation_id, medium.sha256, edge), "image/webp")


def medium_or_404(request: SignedInRequest, medium_id: UUID) -> Medium:
    media = media_of_organisation(request.user.organisation_id).select_related("asset", "target", "organisation")
    return get_object_or_404(media, pk=medium_id)


def media_json(media: list[Medium]) -> list[dict[str, Any]]:
    labels = {medium.asset.pk: asset_label(medium.asset) for medium in media if medium.asset is not None}
    return [shapes.medium_json(medium, labels) for medium in media]


def _file(name: str, media_type: str, download_name: str = "") -> FileResponse:
    try:
        stored = open_stored(name)
    except MediumMissing as error:
        raise Http404 from error
    response = FileResponse(stored, as_attachment=bool(download_name), filename=download_name, content_type=media_type)
    for header, value in FILE_HEADERS.items():
        response[header] = value
    return response


def _asked(request: Request) -> MediaFilter:
    asset_id = ASSET.asked(request)
    return MediaFilter(
        mission=uuid_of(request, "mission"),
        target=TARGET.asked(request),
        asset=None if asset_id is None else get_object_or_404(Asset, pk=asset_id),
        uav=UAV.asked(request),
        kind=asked_choice(request, "kind", MediumKind.values),
        state=asked_choice(request, "state", MediumState.values),
        placement=asked_choice(request, "placement", Placement.values),
        review=asked_choice(request, "review", (NOT_REVIEWED, *Review.values)),
    )


def uuid_of(request: Request, name: str) -> UUID | None:
    """Return an id of the query; None without one. Raises ApiProblem 400."""
    text = request.query_params.get(name, "")
    try:
        return UUID(text) if text else None
    except ValueError as error:
        raise invalid(name, _("An id is needed.")) from error
