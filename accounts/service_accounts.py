"""Service accounts: accounts of an organisation for programs. Nobody signs in with one; its tokens end with no person's leaving.

The user name is `service:ORGANISATION:NAME`, which no person can have, so that the history tells programs from people.
"""

from django.db import IntegrityError, transaction
from django.db.models import Count, F, Max, Q, QuerySet
from django.utils import timezone

from accounts.users import save_person
from workspace.models import ApiToken, Role, User


class NameTaken(ValueError):
    """The organisation has a service account of this name."""


def service_accounts_of(actor: User) -> QuerySet[User]:
    """Those of the actor's organisation, with `valid_tokens` and `last_used_at`."""
    valid = Q(api_tokens__revoked_at=None, api_tokens__expires_at__gt=timezone.now())
    own = User.objects.filter(organisation_id=actor.organisation_id, is_service=True)
    return own.annotate(valid_tokens=Count("api_tokens", filter=valid), last_used_at=Max("api_tokens__last_used_at"))


def name_of(account: User) -> str:
    return account.username.split(":", 2)[2]


def make_service_account(*, actor: User, name: str, role: Role) -> User:
    """Raises NameTaken."""
    username = f"service:{actor.organisation_id}:{name}"
    if User.objects.filter(username__iexact=username).exists():
        raise NameTaken
    account = User(username=username, role=role, organisation_id=actor.organisation_id, is_service=True)
    account.set_unusable_password()
    try:
        with transaction.atomic():
            return save_person(user=account, actor=actor)
    except IntegrityError as error:  # two at the same moment
        raise NameTaken from error


def tokens_of(account: User) -> QuerySet[ApiToken]:
    """Those that work first, then the newest."""
    return account.api_tokens.select_related("user").order_by(F("revoked_at").desc(nulls_first=True), "-created_at")
