"""What outlives a session, or ends others, wants the password again: an open browser that somebody else sits at is not enough."""

import time
from typing import Any

from django.utils import timezone
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse
from rest_framework.request import Request

from workspace.api.errors import ApiProblem

PROVED_AT = "workspace.proved_at"  # in the session, beside its beginning
PROOF_S = 15 * 60
PASSWORD_NEEDED = OpenApiResponse(description="`password_needed`: say it at `/account/proof`.")


def note_proof(session: Any) -> None:
    """Somebody has just shown their password in this session."""
    session[PROVED_AT] = time.time()


def require_proof(request: Request) -> None:
    """Raises ApiProblem 403 `password_needed` unless the password was shown within 15 min: by signing in, or by saying it again."""
    row = getattr(request.session, "in_use", None)
    since_sign_in_s = PROOF_S + 1.0 if row is None else (timezone.now() - row.began_at).total_seconds()
    since_proof_s = time.time() - request.session.get(PROVED_AT, 0.0)
    if min(since_sign_in_s, since_proof_s) > PROOF_S:
        raise ApiProblem(403, "password_needed", _("Say your password again for this."))
