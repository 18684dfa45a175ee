"""Incoming files and their changes: review, apply or discard."""

from typing import Any
from uuid import UUID

from django.conf import settings
from django.db import transaction
from django.http import Http404
from django.urls import reverse
from django.utils.translation import gettext as _
from django.utils.translation import ngettext
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.importers.osm.overpass import WrongArea
from inspection.models import ChangeAction, ImportKind, ImportProposal, ProposalOrigin, ProposalState, Upload
from inspection.selectors.imports import NEWEST_FIRST, changes_of_proposal, proposal_of_id, proposals, upload_of_id
from inspection.serializers.imports import (
    ChangeCollectionSerializer,
    ImportInputSerializer,
    ParametersSerializer,
    ProposalPageSerializer,
    ProposalSerializer,
    change_feature,
    proposal_json,
)
from inspection.services.imports.overpass import area_of
from inspection.services.imports.uploads import UploadTooLarge, check_size_for
from inspection.services.proposals import pipeline
from inspection.services.proposals.undo import UNDO, is_undo, undo_name
from inspection.tasks import send_job_of
from inspection.views.parameters import invalid
from inspection.views.uploads import CuratorsAlone
from workspace.admin_pages.author_names import author_name
from workspace.api.errors import ApiProblem
from workspace.api.idempotency import idempotent
from workspace.api.paging import asked_choice, page_of
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.models import User

IN_ANOTHER_STATE = {409: OpenApiResponse(description="It is in another state; somebody else may have been faster.")}


def _proposal(proposal_id: UUID) -> ImportProposal:
    try:
        return proposal_of_id(proposal_id)
    except ImportProposal.DoesNotExist as error:
        raise Http404 from error


def _answer(request: SignedInRequest, proposal_id: UUID, status: int = 200) -> Response:
    return Response(proposal_json(_proposal(proposal_id), request.user), status=status)


def _too_late(error: pipeline.WrongState, reader: User) -> ApiProblem:
    proposal = error.proposal
    who = author_name(proposal.decided_by, reader)
    words = f"{error} {who} decided it." if who else str(error)
    return ApiProblem(409, "wrong_state", words, details={"state": proposal.state, "decided_by": who, "decided_at": proposal.decided_at})


class ImportList(APIView):
    permission_classes = [CuratorsAlone]

    @extend_schema(
        operation_id="list_imports",
        summary="What came in, newest first",
        parameters=[
            OpenApiParameter("kind", str, enum=ImportKind.values),
            OpenApiParameter("state", str, enum=ProposalState.values),
            *PAGE_PARAMETERS,
        ],
        responses=ProposalPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        kind, state = asked_choice(request, "kind", ImportKind.values), asked_choice(request, "state", ProposalState.values)
        page = page_of(request, proposals(kind=kind, states=[state] if state else None), order=NEWEST_FIRST, default_limit=50)
        return Response({"results": [proposal_json(proposal, request.user, is_brief=True) for proposal in page.rows], "next": page.next})

    @extend_schema(
        operation_id="propose_import",
        summary="Have a file read: what would it change?",
        description="Nothing changes before the proposal is applied: by `apply`, or by itself where `auto_apply` asks for it.",
        request=ImportInputSerializer,
        responses={202: ProposalSerializer},
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        body = ImportInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        values = body.validated_data
        if values["kind"] not in pipeline.FILE_KINDS:
            raise invalid("kind", _("Files of this kind cannot be read."))
        with transaction.atomic():
            proposal = pipeline.start_proposal(
                kind=values["kind"], created_by=request.user, parameters=values.get("parameters", {}),
                provenance=dict(values.get("provenance", {})), auto_apply=values["auto_apply"],
                max_removed_percent=values["max_removed_percent"], **self._where_from(values),
            )  # fmt: skip
            send_job_of(proposal)
        response = _answer(request, proposal.pk, 202)
        response["Location"] = reverse("api-import", args=[proposal.pk])
        return response

    def _where_from(self, values: dict[str, Any]) -> dict[str, Any]:
        if values["kind"] == ImportKind.OSM and "overpass_bbox" in values.get("parameters", {}):
            if not settings.OVERPASS_ADDRESS:
                raise invalid("overpass_bbox", _("No Overpass server is named in the settings."))
            try:
                area_of(values["parameters"])
            except WrongArea as error:
                raise invalid("overpass_bbox", str(error)) from error
            return {"upload": None, "file_name": "overpass.json", "origin": ProposalOrigin.OVERPASS}
        if "upload" not in values:
            raise invalid("upload", _("Send the file first, then name its upload."))
        try:
            upload = upload_of_id(values["upload"])
        except Upload.DoesNotExist as error:
            raise invalid("upload", _("There is no such upload.")) from error
        if not upload.is_complete:
            raise invalid(
                "upload",
                _("Only %(received_bytes)s of %(size_bytes)s bytes have arrived.")
                % {"received_bytes": upload.received_bytes, "size_bytes": upload.size_bytes},
            )
        try:
            check_size_for(values["kind"], upload.size_bytes)
        except UploadTooLarge as error:
            raise ApiProblem(413, "too_large", str(error)) from error
        return {"upload": upload, "file_name": upload.file_name}


class ImportDetail(APIView):
    permission_classes = [CuratorsAlone]

    @extend_schema(operation_id="get_import", summary="One proposal", responses=ProposalSerializer)
    def get(self, request: SignedInRequest, proposal_id: UUID) -> Response:
        return _answer(request, proposal_id)

    @extend_schema(
        operation_id="read_import_again",
        summary="Read the file with other parameters",
        request=ParametersSerializer,
        responses={202: ProposalSerializer} | IN_ANOTHER_STATE,
    )
    def patch(self, request: SignedInRequest, proposal_id: UUID) -> Response:
        parameters = _parameters(request)
        try:
            with transaction.atomic():
                send_job_of(pipeline.read_again(proposal=_proposal(proposal_id), parameters=parameters, actor=request.user))
        except pipeline.WrongState as error:
            raise _too_late(error, request.user) from error
        return _answer(request, proposal_id, 202)


class ImportChanges(APIView):
    permission_classes = [CuratorsAlone]

    @extend_schema(
        operation_id="list_changes",
        summary="The lines of a difference",
        description="Of a large difference the first of each action are kept; the proposal has the numbers of all.",
        parameters=[OpenApiParameter("action", str, enum=ChangeAction.values), *PAGE_PARAMETERS],
        responses=ChangeCollectionSerializer,
    )
    def get(self, request: Request, proposal_id: UUID) -> Response:
        action = asked_choice(request, "action", ChangeAction.values)
        page = page_of(request, changes_of_proposal(_proposal(proposal_id), action=action))
        return Response({"type": "FeatureCollection", "features": [change_feature(change) for change in page.rows], "next": page.next})


class ImportUndo(APIView):
    permission_classes = [CuratorsAlone]

    @extend_schema(
        operation_id="undo_import",
        summary="Propose the undoing of an applied import of assets",
        description="It is shown as a difference and applied like any other import. Rows that a user edited since, or that a later "
        "import changed, stay. A zone set is rolled back instead.",
        request=None,
        responses={202: ProposalSerializer, 409: OpenApiResponse(description="It is not applied, or cannot be undone.")},
    )
    def post(self, request: SignedInRequest, proposal_id: UUID) -> Response:
        proposal = _proposal(proposal_id)
        data_import = proposal.data_import
        if (
            proposal.state != ProposalState.APPLIED
            or data_import is None
            or proposal.kind not in (ImportKind.OSM, ImportKind.ASSETS)
            or is_undo(proposal.parameters)
        ):
            raise ApiProblem(409, "not_undoable", _("Only an applied import of assets can be undone."))
        with transaction.atomic():
            undoing = pipeline.start_proposal(
                kind=proposal.kind, origin=ProposalOrigin.ROLL_BACK, upload=None, file_name=undo_name(data_import),
                parameters={UNDO: data_import.pk}, provenance={}, created_by=request.user,
            )  # fmt: skip
            send_job_of(undoing)
        answer = _answer(request, undoing.pk, 202)
        answer["Location"] = reverse("api-import", args=[undoing.pk])
        return answer


class ImportApply(APIView):
    permission_classes = [CuratorsAlone]

    @extend_schema(
        operation_id="apply_import",
        summary="Make the ground what the file says",
        description="If the ground has changed since the difference was taken, and the difference with it, nothing is applied: the "
        "proposal is `ready` again with the new difference. Where `summary.not_read` lists records with faults, the parameter `seen` "
        "holds the `place` of each; without one of them the answer is 409 `not_seen`, with the missing places in its details. The "
        "parameter `excluded` lists the `key` of each change that is left out.",
        request=ParametersSerializer,
        responses={202: ProposalSerializer} | IN_ANOTHER_STATE,
    )
    def post(self, request: SignedInRequest, proposal_id: UUID) -> Response:
        parameters = _parameters(request)
        try:
            with transaction.atomic():
                send_job_of(pipeline.ask_to_apply(proposal=_proposal(proposal_id), parameters=parameters, actor=request.user))
        except pipeline.WrongState as error:
            raise _too_late(error, request.user) from error
        except pipeline.NotSeen as error:
            words = ngettext(
                "%(count)s record of the file is not read. See it first.",
                "%(count)s records of the file are not read. See each of them first.",
                len(error.places),
            )
            raise ApiProblem(409, "not_seen", words % {"count": len(error.places)}, details={"places": error.places}) from error
        return _answer(request, proposal_id, 202)


class ImportDiscard(APIView):
    permission_classes = [CuratorsAlone]

    @extend_schema(
        operation_id="discard_import", summary="Throw a proposal away", request=None, responses={200: ProposalSerializer} | IN_ANOTHER_STATE
    )
    def post(self, request: SignedInRequest, proposal_id: UUID) -> Response:
        try:
            pipeline.discard_proposal(proposal=_proposal(proposal_id), actor=request.user)
        except pipeline.WrongState as error:
            raise _too_late(error, request.user) from error
        return _answer(request, proposal_id)


def _parameters(request: Request) -> dict[str, Any]:
    body = ParametersSerializer(data=request.data)
    body.is_valid(raise_exception=True)
    return body.validated_data.get("parameters", {})
