"""Uploads of media: by JSON, and by the tus protocol 1.0.0 (tus.io/protocols/resumable-upload), so that its clients work."""

import base64
import binascii
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import IO, Any
from uuid import UUID

from django.conf import settings
from django.shortcuts import get_object_or_404
from django.urls import reverse
from django.utils.translation import gettext as _
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.parsers import BaseParser
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from results.models import MediaUpload
from results.selectors.media import open_uploads_of_organisation
from results.serializers.media import MAX_BYTES, MediaUploadInputSerializer, MediaUploadSerializer, known_upload_json, upload_json
from results.services.uploads import (
    PART_BYTES,
    MediaUploadRefused,
    NoRoom,
    StoreFull,
    TooLarge,
    UnsupportedType,
    WrongHash,
    WrongOffset,
    adopt_subject,
    begin_upload,
    delete_upload,
    known_media,
    receive_part,
    unfinished_upload,
)
from results.views.subjects import subject_of
from workspace.api.errors import ApiProblem
from workspace.api.signed_in import SignedInRequest

TUS_VERSION = "1.0.0"
TUS_EXTENSIONS = "creation,termination"
TUS_HEADERS = {"Tus-Resumable": TUS_VERSION, "Cache-Control": "no-store"}
STATED_FIELDS = {"mission", "uav", "target", "asset", "sha256"}
NUMBERS = {"uav", "target", "asset"}
BYTES = {"type": "integer", "maximum": MAX_BYTES}
TUS_RESUMABLE = OpenApiParameter("Tus-Resumable", str, OpenApiParameter.HEADER, enum=[TUS_VERSION], description="of tus clients")
UPLOAD_OFFSET = OpenApiParameter(
    "Upload-Offset", BYTES | {"minimum": 0}, OpenApiParameter.HEADER, required=True, description="the byte at which this part begins"
)
OTHER_VERSION = {412: OpenApiResponse(description="`tus_version`: the version of tus that is asked for is not spoken.")}
NO_ROOM = OpenApiResponse(description="`no_room`: the organisation's photos and videos leave no room for it.")


class TusPartParser(BaseParser):
    """The raw bytes of a part, within the limit of one part."""

    media_type = "application/offset+octet-stream"

    def parse(self, stream: IO[bytes], media_type: str | None = None, parser_context: Mapping[str, Any] | None = None) -> Any:
        content = stream.read(PART_BYTES + 1)
        if len(content) > PART_BYTES:
            raise ApiProblem(
                413,
                "too_large",
                _("A part has at most %(part_bytes)s bytes.") % {"part_bytes": PART_BYTES},
                details={"part_bytes": PART_BYTES},
            )
        return content


class TusView(APIView):
    """A view of the tus protocol. Requests of another version get a 412."""

    throttle_scope = "media-uploads"

    def initial(self, request: Request, *args: Any, **kwargs: Any) -> None:
        super().initial(request, *args, **kwargs)
        version = request.headers.get("Tus-Resumable", TUS_VERSION)
        if version != TUS_VERSION and request.method != "OPTIONS":
            raise ApiProblem(412, "tus_version", _("The tus protocol is spoken in version %(version)s.") % {"version": TUS_VERSION})

    def finalize_response(self, request: Any, response: Any, *args: Any, **kwargs: Any) -> Any:
        response = super().finalize_response(request, response, *args, **kwargs)
        response["Tus-Resumable"] = response["Tus-Version"] = TUS_VERSION
        response["Cache-Control"] = "no-store"
        return response

    def options(self, request: Any, *args: Any, **kwargs: Any) -> Response:
        headers = {"Tus-Extension": TUS_EXTENSIONS, "Tus-Max-Size": str(settings.MAX_MEDIUM_BYTES)}
        return Response(status=204, headers=headers)


class MediaUploads(TusView):
    @extend_schema(
        operation_id="begin_media_upload",
        summary="Announce a photo or video",
        description=(
            "200 with `is_known` where your organisation has a file of this hash: it need not be sent; 200 without it where you have "
            "begun to send this file before: continue from `received_bytes`. By tus 1.0.0: Upload-Length, and "
            "Upload-Metadata with `filename` and, if known, `sha256`, `mission`, `uav`, `target`, `asset`."
        ),
        parameters=[
            OpenApiParameter(
                "Upload-Length", BYTES | {"minimum": 1}, OpenApiParameter.HEADER, description="of tus clients: bytes of the file"
            ),
            OpenApiParameter("Upload-Metadata", str, OpenApiParameter.HEADER, description="of tus clients: names and values in Base64"),
            TUS_RESUMABLE,
        ],
        request=MediaUploadInputSerializer,
        responses={200: MediaUploadSerializer, 201: MediaUploadSerializer, 409: NO_ROOM, **OTHER_VERSION},
    )
    def post(self, request: SignedInRequest) -> Response:
        is_tus = "Upload-Length" in request.headers
        if is_tus and request.META.get("CONTENT_LENGTH") not in (None, "", "0"):
            raise ApiProblem(400, "invalid", _("Either Upload-Length or a body announces a file."))
        body = MediaUploadInputSerializer(data=_tus_body(request) if is_tus else request.data)
        body.is_valid(raise_exception=True)
        values = body.validated_data
        sha256 = values.get("sha256", "")
        if not is_tus and sha256 and (medium := known_media(request.user.organisation_id, [sha256]).get(sha256)):
            adopt_subject(medium, subject_of(request.user, values))
            return Response(known_upload_json(medium))
        if not is_tus and sha256 and (begun := unfinished_upload(request.user, sha256, values["size_bytes"])):
            return Response(upload_json(begun))
        with upload_problems():
            upload = begin_upload(
                user=request.user, file_name=values["file_name"], size_bytes=values["size_bytes"], sha256=sha256,
                subject=subject_of(request.user, values),
            )  # fmt: skip
        address = reverse("api-media-upload", args=[upload.pk])
        return Response(upload_json(upload), status=201, headers={"Location": request.build_absolute_uri(address) if is_tus else address})


class MediaUploadDetail(TusView):
    parser_classes = [TusPartParser]

    @extend_schema(
        operation_id="get_media_upload",
        summary="How much of a file is here",
        description="By HEAD, too: Upload-Offset and Upload-Length.",
        parameters=[TUS_RESUMABLE],
        responses={200: MediaUploadSerializer, **OTHER_VERSION},
    )
    def get(self, request: SignedInRequest, media_upload_id: UUID) -> Response:
        upload = _upload(request, media_upload_id)
        return Response(upload_json(upload), headers=_offset(upload) | {"Upload-Length": str(upload.size_bytes)})

    @extend_schema(
        operation_id="send_media_part",
        summary="Send the next part of a file",
        description="After a cut, ask how much is here and continue from there. With the last byte the hash is checked.",
        parameters=[UPLOAD_OFFSET, TUS_RESUMABLE],
        request={"application/offset+octet-stream": OpenApiTypes.BINARY},
        responses={
            204: OpenApiResponse(description="Stored; Upload-Offset is how much is here now."),
            409: OpenApiResponse(description="`offset`: the part does not begin where the bytes that are here end."),
            422: OpenApiResponse(description="`wrong_hash`, or `unsupported_type` by its content."),
            507: OpenApiResponse(description="`store_full`: what was received before stays."),
            **OTHER_VERSION,
        },
    )
    def patch(self, request: SignedInRequest, media_upload_id: UUID) -> Response:
        upload = _upload(request, media_upload_id)
        content = request.data if isinstance(request.data, bytes) else b""  # without a body no parser runs
        offset = request.headers.get("Upload-Offset", "")
        if not (offset.isascii() and offset.isdigit() and len(offset) < 16):
            raise ApiProblem(400, "invalid", _("Upload-Offset states the byte at which the part begins."))
        with upload_problems(upload):
            upload = receive_part(upload=upload, offset=int(offset), content=content)
        return Response(status=204, headers=_offset(upload))

    @extend_schema(
        operation_id="delete_media_upload", summary="Cancel an upload", parameters=[TUS_RESUMABLE], responses={204: None, **OTHER_VERSION}
    )
    def delete(self, request: SignedInRequest, media_upload_id: UUID) -> Response:
        delete_upload(upload=_upload(request, media_upload_id))
        return Response(status=204)


@contextmanager
def upload_problems(upload: MediaUpload | None = None) -> Iterator[None]:
    """Translate what the service raises. A file of an unsupported kind is forgotten at once."""
    try:
        yield
    except TooLarge as error:
        raise ApiProblem(413, "too_large", str(error)) from error
    except NoRoom as error:
        raise ApiProblem(409, "no_room", str(error)) from error
    except WrongOffset as error:
        received = MediaUpload.objects.filter(pk=upload.pk).values_list("received_bytes", flat=True).first() if upload else None
        raise ApiProblem(409, "offset", str(error), details={"received_bytes": received}) from error
    except WrongHash as error:
        raise ApiProblem(422, "wrong_hash", str(error)) from error
    except UnsupportedType as error:
        if upload is not None:
            delete_upload(upload=upload)
        raise ApiProblem(422, "unsupported_type", str(error)) from error
    except MediaUploadRefused as error:
        raise ApiProblem(400, "invalid", str(error)) from error
    except StoreFull as error:
        raise ApiProblem(507, "store_full", _("The disk of the media store is full. Tell the operator of this installation.")) from error


def _upload(request: SignedInRequest, media_upload_id: UUID) -> MediaUpload:
    return get_object_or_404(open_uploads_of_organisation(request.user.organisation_id), pk=media_upload_id)


def _offset(upload: MediaUpload) -> dict[str, str]:
    return {"Upload-Offset": str(upload.received_bytes)}


def _tus_body(request: Request) -> dict[str, Any]:
    """Return the headers of a creation as the body of JSON. Raises ApiProblem 400."""
    body: dict[str, Any] = {}
    for entry in filter(None, (part.strip() for part in request.headers.get("Upload-Metadata", "").split(","))):
        name, _space, value = entry.partition(" ")
        try:
            text = base64.b64decode(value, validate=True).decode()
        except (binascii.Error, UnicodeDecodeError) as error:
            raise ApiProblem(
                400, "invalid", _("Upload-Metadata: the value of %(name)s is no text in Base64.") % {"name": name[:50]}
            ) from error
        if name in STATED_FIELDS:
            body[name] = int(text) if name in NUMBERS and text.isascii() and text.isdigit() and len(text) < 10 else text
        elif name in ("filename", "name"):
            body.setdefault("file_name", text)
    length = request.headers["Upload-Length"]
    body["size_bytes"] = int(length) if length.isascii() and length.isdigit() and len(length) < 17 else length
    return {"file_name": "file"} | body
