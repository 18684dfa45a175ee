"""What is kept of each sign-in and sign-out: who, from where, with which browser, with which outcome; never what was typed."""

from datetime import timedelta

from django.conf import settings
from django.http import HttpRequest
from django.utils import timezone

from workspace.models import SignInEntry, SignInOutcome, User
from workspace.sessions.sign_in_attempts import address_of, is_first_in, network_of

HELD_BACK_INTERVAL_S = 60  # of one name from one network: a flood of tries is no flood of rows


def record_sign_in(request: HttpRequest, outcome: SignInOutcome, *, user: User | None = None, name: str = "") -> None:
    """Of a name that nobody has only the try is kept: people type passwords there."""
    address = address_of(request)
    if outcome == SignInOutcome.HELD_BACK and not is_first_in(HELD_BACK_INTERVAL_S, name, network_of(address)):
        return
    if user is None and name:
        user = User.objects.filter(username=name).first()
    agent = "".join(character for character in request.headers.get("User-Agent", "") if character.isprintable())
    SignInEntry.objects.create(user=user, outcome=outcome, address=address[:45], user_agent=agent[:200])


def forget_old_sign_ins() -> int:
    kept_since = timezone.now() - timedelta(days=settings.SIGN_IN_LOG_DAYS)
    deleted, _ = SignInEntry.objects.filter(recorded_at__lt=kept_since).delete()
    return deleted
