"""API endpoints for administrators: service accounts and their tokens."""

from django.http import Http404
from django.urls import reverse
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from accounts import services
from accounts.login import PASSWORD_NEEDED, require_reauthentication
from accounts.serializers import (
    NewTokenSerializer,
    ServiceAccountChangeSerializer,
    ServiceAccountInputSerializer,
    ServiceAccountPageSerializer,
    ServiceAccountSerializer,
    TokenInputSerializer,
    TokenListSerializer,
    TokenSerializer,
    with_secret,
)
from workspace.api.errors import ApiProblem
from workspace.api.paging import page_of
from workspace.api.permissions import AdministratorsInTheBrowser
from workspace.api.preconditions import IF_MATCH_REQUIRED, PRECONDITION_ANSWERS, etag_of, expected_revision
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.models import Role, User

MAX_SHOWN_TOKENS = 200


def _account(request: SignedInRequest, account_id: int) -> User:
    try:
        return services.service_accounts_of(request.user).get(pk=account_id)
    except User.DoesNotExist as error:
        raise Http404 from error


def _answer(request: SignedInRequest, account_id: int, *, status: int = 200) -> Response:
    account = _account(request, account_id)
    headers = etag_of(services.revision_of_user(account))
    if status == 201:
        headers["Location"] = reverse("api-service-account", args=[account.pk])
    return Response(ServiceAccountSerializer(account).data, status=status, headers=headers)


class ServiceAccountList(APIView):
    permission_classes = [AdministratorsInTheBrowser]

    @extend_schema(
        operation_id="list_service_accounts",
        summary="Accounts for programs of one's organisation, by name",
        parameters=PAGE_PARAMETERS,
        responses=ServiceAccountPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        page = page_of(request, services.service_accounts_of(request.user), order=("username",))
        return Response({"results": ServiceAccountSerializer(page.rows, many=True).data, "next": page.next})

    @extend_schema(
        operation_id="make_service_account",
        summary="Make an account for a program",
        description="Nobody signs in with it, and no person's leaving ends it; its tokens do what its role and their scopes allow, but"
        " do not change people, sessions, tokens and rules. Not with a token.",
        request=ServiceAccountInputSerializer,
        responses={201: ServiceAccountSerializer, 409: OpenApiResponse(description="There is one of this name.")},
    )
    def post(self, request: SignedInRequest) -> Response:
        body = ServiceAccountInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        name, role = body.validated_data["name"], Role(body.validated_data["role"])
        try:
            account = services.make_service_account(actor=request.user, name=name, role=role)
        except services.AccountNameTaken as error:
            raise ApiProblem(409, "name_taken", _("There is a service account of this name.")) from error
        return _answer(request, account.pk, status=201)


class ServiceAccountDetail(APIView):
    permission_classes = [AdministratorsInTheBrowser]

    @extend_schema(operation_id="get_service_account", summary="One account for a program", responses=ServiceAccountSerializer)
    def get(self, request: SignedInRequest, account_id: int) -> Response:
        return _answer(request, account_id)

    @extend_schema(
        operation_id="change_service_account",
        summary="Change the role of an account for a program, or disable it",
        description="While it is disabled none of its tokens works. Not with a token.",
        parameters=[IF_MATCH_REQUIRED],
        request=ServiceAccountChangeSerializer,
        responses={200: ServiceAccountSerializer, **PRECONDITION_ANSWERS},
    )
    def patch(self, request: SignedInRequest, account_id: int) -> Response:
        body = ServiceAccountChangeSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        account = _account(request, account_id)
        try:
            services.change_user(user_id=account.pk, actor=request.user, seen_revision=expected_revision(request), **body.validated_data)
        except services.ChangedMeanwhile as error:
            current = ServiceAccountSerializer(_account(request, account_id)).data
            words = _("Somebody else has changed {name} in the meantime. Look again.").format(name=services.name_of(account))
            raise ApiProblem(412, "changed", words, details={"current": current}) from error
        return _answer(request, account_id)


class ServiceAccountTokens(APIView):
    """The response with a token is not stored, so a repeated request makes another token."""

    permission_classes = [AdministratorsInTheBrowser]

    @extend_schema(
        operation_id="list_service_account_tokens",
        summary="Tokens of an account for a program, those that work first, then the newest",
        responses=TokenListSerializer,
    )
    def get(self, request: SignedInRequest, account_id: int) -> Response:
        tokens = services.tokens_of(_account(request, account_id))[:MAX_SHOWN_TOKENS]
        return Response({"results": TokenSerializer(tokens, many=True).data})

    @extend_schema(
        operation_id="make_service_account_token",
        summary="Make a token of an account for a program; only this answer shows it",
        description="Not with a token, and within 15 min of saying one's password. A repeated request makes another token.",
        request=TokenInputSerializer,
        responses={201: NewTokenSerializer, 403: PASSWORD_NEEDED, 409: OpenApiResponse(description="There are too many that work.")},
    )
    def post(self, request: SignedInRequest, account_id: int) -> Response:
        require_reauthentication(request)
        account = _account(request, account_id)
        body = TokenInputSerializer(data=request.data, context={"user": account})
        body.is_valid(raise_exception=True)
        try:
            row, token = services.make_token(user=account, actor=request.user, **body.validated_data)
        except services.TooManyTokens as error:
            message = _("It has {count} tokens that work. Revoke one that is not needed any more.").format(count=services.MAX_TOKENS)
            raise ApiProblem(409, "too_many_tokens", message) from error
        return Response(with_secret(NewTokenSerializer, row, token=token), status=201, headers={"Cache-Control": "no-store"})


class ServiceAccountToken(APIView):
    permission_classes = [AdministratorsInTheBrowser]

    @extend_schema(
        operation_id="revoke_service_account_token", summary="Revoke a token of an account for a program", responses=TokenSerializer
    )
    def delete(self, request: SignedInRequest, account_id: int, token_id: int) -> Response:
        token = services.tokens_of(_account(request, account_id)).filter(pk=token_id).first()
        if token is None:
            raise Http404
        return Response(TokenSerializer(services.revoke_token(token=token, actor=request.user)).data)
