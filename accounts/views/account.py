"""API endpoints of the own account and of its organisation: name and time zone."""

from collections.abc import Mapping
from typing import Any

from django.contrib.auth import update_session_auth_hash
from django.db import IntegrityError
from django.db.models import F
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from accounts import services
from accounts.email_addresses import send_verification
from accounts.identity_provider import identity_provider
from accounts.login import LOCAL_SIGN_IN_OFF, PASSWORD_NEEDED, record_sign_in, require_reauthentication
from accounts.serializers import (
    AccountChangeSerializer,
    AccountSerializer,
    MapViewSerializer,
    NewTokenSerializer,
    OrganisationSerializer,
    PasswordChangeSerializer,
    SignInPageSerializer,
    SignInSerializer,
    TokenInputSerializer,
    TokenListSerializer,
    TokenSerializer,
    VerificationMailSerializer,
    with_secret,
)
from accounts.single_sign_on import require_local_sign_in
from workspace.api.errors import ApiProblem
from workspace.api.paging import page_of
from workspace.api.permissions import ADMINISTRATORS, EVERYBODY, InTheBrowserAlone
from workspace.api.preconditions import IF_MATCH_REQUIRED, PRECONDITION_ANSWERS, etag_of, expected_revision
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.models import Organisation, SignInOutcome, User
from workspace.sessions.sign_in_attempts import PASSWORD_CHANGES, TooManyAttempts, count_attempt


def check_password(request: SignedInRequest, name: str, password: str) -> None:
    """Check the authenticated user's password. Raises ApiProblem: 400 where it is wrong, 429 after too many tries."""
    try:
        count_attempt(PASSWORD_CHANGES, str(request.user.pk))
    except TooManyAttempts as held:
        raise ApiProblem(429, "held_back", _("Too many tries. Wait 15 min, then try again."), retry_after_s=held.wait_s) from held
    if not request.user.check_password(password):
        message = _("This is not your password.")
        record_sign_in(request, SignInOutcome.WRONG, user=request.user)
        raise ApiProblem(400, "invalid", message, details={name: [message]})


class Account(APIView):
    write_roles = EVERYBODY
    permission_classes = [InTheBrowserAlone]

    @extend_schema(operation_id="get_account", summary="Who is signed in, and what they prefer", responses=AccountSerializer)
    def get(self, request: SignedInRequest) -> Response:
        return Response(AccountSerializer(request.user).data)

    @extend_schema(
        operation_id="change_account",
        summary="Change one's own name and preferences",
        description="Not with a token.",
        request=AccountChangeSerializer,
        responses=AccountSerializer,
    )
    def patch(self, request: SignedInRequest) -> Response:
        body = AccountChangeSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        return Response(AccountSerializer(services.change_account(user=request.user, **body.validated_data)).data)


class AccountMapView(APIView):
    write_roles = EVERYBODY
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="put_map_view",
        summary="Where the own pages' maps open",
        description="Stored when the map has been moved. Not with a token.",
        request=MapViewSerializer,
        responses={204: OpenApiResponse(description="Stored.")},
    )
    def put(self, request: SignedInRequest) -> Response:
        body = MapViewSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        User.objects.filter(pk=request.user.pk).update(map_view=body.validated_data)
        return Response(status=204)


class AccountEmailAddress(APIView):
    write_roles = EVERYBODY
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="mail_verification_link",
        summary="Have a link mailed that verifies one's e-mail address",
        description="Five in a quarter of an hour. Not with a token.",
        request=None,
        responses=VerificationMailSerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        try:
            count_attempt("verification mails to", str(request.user.pk))
        except TooManyAttempts as held:
            message = _("Too many mails were asked for. Wait 15 min, then try again.")
            raise ApiProblem(429, "held_back", message, retry_after_s=held.wait_s) from held
        return Response({"was_mailed": send_verification(request=request, user=request.user)})


class AccountPassword(APIView):
    write_roles = EVERYBODY
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="change_password",
        summary="Change one's own password",
        description="All other sessions end, with `end_tokens` all tokens, too. Not with a token."
        " Five wrong tries in a quarter of an hour.",
        request=PasswordChangeSerializer,
        responses={204: OpenApiResponse(description="Changed."), 403: LOCAL_SIGN_IN_OFF},
    )
    def post(self, request: SignedInRequest) -> Response:
        require_local_sign_in()
        body = PasswordChangeSerializer(data=request.data, context={"user": request.user})
        body.is_valid(raise_exception=True)
        check_password(request, "old_password", body.validated_data["old_password"])
        services.change_password(
            user=request.user, password=body.validated_data["new_password"], ends_tokens=body.validated_data["end_tokens"]
        )
        update_session_auth_hash(request, request.user)
        return Response(status=204)


class AccountTokens(APIView):
    """The response with a token is not stored, so a repeated request makes another token."""

    write_roles = EVERYBODY
    permission_classes = [InTheBrowserAlone]

    @extend_schema(
        operation_id="list_tokens", summary="One's own tokens, those that work first, then the newest", responses=TokenListSerializer
    )
    def get(self, request: SignedInRequest) -> Response:
        tokens = request.user.api_tokens.order_by(F("revoked_at").desc(nulls_first=True), "-created_at")[:200]
        return Response({"results": TokenSerializer(tokens, many=True).data})

    @extend_schema(
        operation_id="make_token",
        summary="Make a token; only this answer shows it",
        description="Not with a token, and within 15 min of saying one's password. A repeated request makes another token.",
        request=TokenInputSerializer,
        responses={201: NewTokenSerializer, 403: PASSWORD_NEEDED, 409: OpenApiResponse(description="There are too many that work.")},
    )
    def post(self, request: SignedInRequest) -> Response:
        require_reauthentication(request)
        body = TokenInputSerializer(data=request.data, context={"user": request.user})
        body.is_valid(raise_exception=True)
        try:
            row, token = services.make_token(user=request.user, **body.validated_data)
        except services.TooManyTokens as error:
            message = _("You have {count} tokens that work. Revoke one that is not needed any more.").format(count=services.MAX_TOKENS)
            raise ApiProblem(409, "too_many_tokens", message) from error
        return Response(with_secret(NewTokenSerializer, row, token=token), status=201)


class AccountToken(APIView):
    write_roles = EVERYBODY
    permission_classes = [InTheBrowserAlone]

    @extend_schema(operation_id="revoke_token", summary="Revoke one of one's own tokens", responses=TokenSerializer)
    def delete(self, request: SignedInRequest, token_id: int) -> Response:
        token = request.user.api_tokens.filter(pk=token_id).first()
        if token is None:
            raise ApiProblem(404, "not_found", _("You have no such token."))
        return Response(TokenSerializer(services.revoke_token(token=token, actor=request.user)).data)


class AccountSignIns(APIView):
    @extend_schema(
        operation_id="list_own_sign_ins",
        summary="When and from where somebody signed in, or tried to, with one's own name; newest first",
        parameters=PAGE_PARAMETERS,
        responses=SignInPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        page = page_of(request, request.user.sign_ins.select_related("user"), order=("-recorded_at", "-pk"))
        return Response({"results": SignInSerializer(page.rows, many=True).data, "next": page.next})


class OwnOrganisation(APIView):
    write_roles = ADMINISTRATORS
    permission_classes = [InTheBrowserAlone]

    @extend_schema(operation_id="get_organisation", summary="One's organisation", responses=OrganisationSerializer)
    def get(self, request: SignedInRequest) -> Response:
        return self._answer(request.user.organisation)

    @extend_schema(
        operation_id="change_organisation",
        summary="Change the name or time zone of one's organisation",
        description="Administrators alone. Pages show times in this zone to users who chose none. Not with a token.",
        parameters=[IF_MATCH_REQUIRED],
        request=OrganisationSerializer,
        responses={
            200: OrganisationSerializer,
            409: OpenApiResponse(description="Another organisation has this name, or the identity provider assigns users by it."),
            **PRECONDITION_ANSWERS,
        },
    )
    def patch(self, request: SignedInRequest) -> Response:
        organisation, revision = request.user.organisation, expected_revision(request)
        body = OrganisationSerializer(organisation, data=request.data, partial=True)
        body.is_valid(raise_exception=True)
        _refuse_name(organisation, body.validated_data)
        try:
            changed = services.change_organisation(
                organisation=organisation, actor=request.user, values=body.validated_data, expected_revision=revision
            )
        except IntegrityError as error:  # another one took the name meanwhile
            raise ApiProblem(409, "name_taken", _("Another organisation has this name.")) from error
        except services.OrganisationChanged as error:
            raise ApiProblem(412, "changed", str(error), details={"current": OrganisationSerializer(error.organisation).data}) from error
        return self._answer(changed)

    @staticmethod
    def _answer(organisation: Organisation) -> Response:
        return Response(OrganisationSerializer(organisation).data, headers=etag_of(organisation.revision))


def _refuse_name(organisation: Organisation, values: Mapping[str, Any]) -> None:
    """Refuse a change of the name by which the identity provider assigns users to organisations."""
    provider = identity_provider()
    if provider is not None and provider.organisation_claim and values.get("name", organisation.name) != organisation.name:
        raise ApiProblem(409, "name_of_provider", _("The identity provider assigns users by this name. It is changed by the operators."))
