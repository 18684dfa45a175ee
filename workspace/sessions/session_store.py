"""Django's database sessions with an idle timeout. It is SESSION_ENGINE."""

from typing import Any

from django.contrib.sessions.backends.db import SessionStore as DatabaseStore
from django.contrib.sessions.models import Session
from django.utils import timezone

from workspace.models import BrowserSession
from workspace.sessions.browser_sessions import session_ends_at


class SessionStore(DatabaseStore):
    """Reads `in_use` together with the session, so that checking the times costs no query."""

    in_use: BrowserSession | None = None

    @classmethod
    def get_model_class(cls) -> type[Session]:
        return Session

    def _get_session_from_db(self) -> Any:
        now = timezone.now()
        found = Session.objects.select_related("in_use").filter(session_key=self.session_key, expire_date__gt=now).first()
        in_use = getattr(found, "in_use", None)
        if found is not None and in_use is not None and session_ends_at(in_use) <= now:
            found.delete()
            found = None
        self.in_use = in_use if found is not None else None
        if found is None:
            self._session_key = None
        return found
