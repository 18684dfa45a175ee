"""State of live pages, for clients without websockets."""

from typing import Any
from uuid import UUID

from django.http import Http404, HttpRequest, HttpResponse
from django.http.response import HttpResponseBase
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.exceptions import ValidationError
from rest_framework.request import Request
from rest_framework.views import APIView

from telemetry.live.messages import live_text, server_time
from telemetry.live.snapshot import etag_of, page_snapshot
from telemetry.serializers.live import LiveAnswerSerializer
from workspace.api.signed_in import SignedInRequest
from workspace.locale_negotiation import language_of_request


class Live(APIView):
    def dispatch(self, request: HttpRequest, *args: Any, **kwargs: Any) -> HttpResponseBase:
        """Drop the view's reference to the response, which is often 1 MB.

        View and request form a reference cycle, which would keep the response until the next garbage collection.
        """
        response = super().dispatch(request, *args, **kwargs)
        del self.response
        return response

    @extend_schema(
        operation_id="get_live",
        summary="What flies: UAVs as measured and estimated, missions, alerts, commands, offers of another plan",
        description="What a live page shows at this moment, as its websocket (`/ws/live`, `/ws/missions/{id}/live`) tells it first.",
        parameters=[
            OpenApiParameter("mission", UUID, description="only what belongs to it"),
            OpenApiParameter("If-None-Match", str, OpenApiParameter.HEADER, description="the ETag as last seen; 304 while nothing changes"),
        ],
        responses={200: LiveAnswerSerializer, 304: OpenApiResponse(description="Nothing has changed.")},
    )
    def get(self, request: SignedInRequest) -> HttpResponse:
        mission = _asked_mission(request)
        language = language_of_request(request.user, request)
        known = request.headers.get("If-None-Match", "").removeprefix("W/")  # a proxy that compresses responses makes the ETag weak
        snapshot = page_snapshot(request.user.organisation_id, mission, language, known=known)
        if mission is not None and ("missions", str(mission)) not in snapshot.shown:
            raise Http404
        headers = {"ETag": etag_of(snapshot, language), "Cache-Control": "private, no-cache"}
        if headers["ETag"] == known:
            return HttpResponse(status=304, headers=headers)
        body = f'{{"server_time":"{server_time()}","live":{live_text(snapshot, mission, language)}}}'
        return HttpResponse(body, content_type="application/json", headers=headers)


def _asked_mission(request: Request) -> UUID | None:
    text = request.query_params.get("mission")
    if text is None:
        return None
    try:
        return UUID(text)
    except ValueError:
        raise ValidationError({"mission": "This is no mission's id."}) from None
