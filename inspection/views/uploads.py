"""Upload endpoints: announced with name and size, received part by part, resumable."""

from uuid import UUID

from django.http import Http404
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import Upload
from inspection.selectors.imports import upload_of_id
from inspection.serializers.imports import UploadInputSerializer, UploadSerializer, upload_json
from inspection.services.imports.uploads import (
    TooManyUploads,
    UploadGap,
    UploadInUse,
    UploadRefused,
    UploadTooLarge,
    begin_upload,
    delete_upload,
    receive_part,
)
from workspace.api.errors import ApiProblem
from workspace.api.parsers import OctetParser
from workspace.api.permissions import CURATING, CURATORS, RolePermission
from workspace.api.signed_in import SignedInRequest


class CuratorsAlone(RolePermission):
    """Permission for curators only, to read as well as to write."""

    def has_permission(self, request: Request, view: object) -> bool:
        self.message = "Only curators bring data in. Ask an administrator for the curator role."
        if not (request.user.is_authenticated and request.user.role in CURATORS):
            return False
        return self.token_reaches(request, CURATING)


def _upload(upload_id: UUID) -> Upload:
    try:
        return upload_of_id(upload_id)
    except Upload.DoesNotExist as error:
        raise Http404 from error


class UploadList(APIView):
    permission_classes = [CuratorsAlone]

    @extend_schema(
        operation_id="begin_upload",
        summary="Announce a file",
        description="409 `too_many_uploads` where the organisation's files that are kept leave no room for it.",
        request=UploadInputSerializer,
        responses={201: UploadSerializer, 409: OpenApiResponse(description="The organisation's files that are kept leave no room.")},
    )
    def post(self, request: SignedInRequest) -> Response:
        body = UploadInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        try:
            upload = begin_upload(**body.validated_data, created_by=request.user)
        except UploadTooLarge as error:
            raise ApiProblem(413, "too_large", str(error)) from error
        except TooManyUploads as error:
            raise ApiProblem(409, "too_many_uploads", str(error)) from error
        return Response(upload_json(upload), status=201)


class UploadDetail(APIView):
    permission_classes = [CuratorsAlone]

    @extend_schema(operation_id="get_upload", summary="How much of a file is here", responses=UploadSerializer)
    def get(self, request: Request, upload_id: UUID) -> Response:
        return Response(upload_json(_upload(upload_id)))

    @extend_schema(
        operation_id="delete_upload",
        summary="Forget a file",
        responses={204: None, 409: OpenApiResponse(description="An open import needs it.")},
    )
    def delete(self, request: Request, upload_id: UUID) -> Response:
        try:
            delete_upload(upload=_upload(upload_id))
        except UploadInUse as error:
            raise ApiProblem(409, "in_use", str(error)) from error
        return Response(status=204)


class UploadBytes(APIView):
    permission_classes = [CuratorsAlone]
    parser_classes = [OctetParser]

    @extend_schema(
        operation_id="send_bytes",
        summary="Send the part of a file that begins at a byte",
        description="A part that is here already does no harm. After a cut, ask how much is here and go on from there.",
        request={"application/octet-stream": OpenApiTypes.BINARY},
        responses={200: UploadSerializer, 409: OpenApiResponse(description="Bytes before these are missing.")},
    )
    def put(self, request: Request, upload_id: UUID, first_byte: int) -> Response:
        upload = _upload(upload_id)
        content = request.data if isinstance(request.data, bytes) else b""  # without a body no parser runs
        try:
            upload = receive_part(upload=upload, first_byte=first_byte, content=content)
        except UploadGap as error:
            raise ApiProblem(409, "gap", str(error), details={"received_bytes": upload_of_id(upload.pk).received_bytes}) from error
        except UploadRefused as error:
            raise ApiProblem(400, "invalid", str(error)) from error
        return Response(upload_json(upload))
