"""A good client of Spanwise under Locust: a browser's session, conditional requests, retries with a key, and a book of what was promised.

What fails and may be asked again (no answer, 408, 425, 429, 502, 503, 504) is asked again, after Retry-After where there is one, for a
minute at most: every POST goes with an Idempotency-Key. Those tries are counted apart ("again: ..."), and only what a person would see in
the end counts as a failure. A 500 is one at once.
"""

import os
import re
import time
from collections.abc import Collection
from typing import Any
from uuid import uuid4

import gevent
import orjson
from locust import FastHttpUser

from deploy.load.day import book as kinds
from deploy.load.day.book import Book
from deploy.load.day.site import Site
from deploy.load.kept_connections import keep_all_connections
from deploy.load.trust import trusting

LATER = {0, 408, 425, 429, 502, 503, 504}
TIMEOUT_S = 60.0
FIRST_PAUSE_S, MAX_PAUSE_S = 0.5, 5.0
FORM_TOKEN = re.compile(rb'name="csrfmiddlewaretoken" value="([^"]+)"')
UNSAFE = {"POST", "PATCH", "PUT", "DELETE"}
trusted = trusting(os.environ.get("SPANWISE_DAY_AUTHORITY") or None)
keep_all_connections()


class GaveUp(Exception):
    """What was asked was not answered well; Locust has counted it."""


class Client(FastHttpUser):
    """A user with a book. `ask` returns the answer, or raises GaveUp."""

    abstract = True
    insecure = False
    ssl_context_factory = staticmethod(trusted)
    network_timeout = 60.0
    connection_timeout = 20.0
    max_retries = 0
    concurrency = 2
    default_headers = {"Accept-Encoding": "gzip"}
    site: Site
    book: Book

    def ask(
        self,
        method: str,
        path: str,
        name: str,
        body: Any = None,
        *,
        ok: Collection[int] = (200,),
        key: str = "",
        patience_s: float = TIMEOUT_S,
        **headers: str,
    ) -> Any:
        """`ok` are statuses that are right here. A POST is given a key of its own, if it has none."""
        key = key or (str(uuid4()) if method == "POST" else "")
        sent = self.headers_for(method) | headers | ({"Idempotency-Key": key} if key else {})
        data = None if body is None else orjson.dumps(body)
        if data is not None:
            sent["Content-Type"] = "application/json"
        began_s, pause_s = time.monotonic(), FIRST_PAUSE_S
        while True:
            with self.client.request(
                method, path, name=name, data=data, headers=sent, catch_response=True, allow_redirects=False
            ) as answer:
                status = answer.status_code
                if status in ok:
                    answer.success()
                    return answer
                why = f"answered {status}: {(answer.text or '')[:200] if status else answer.error}"
                if status not in LATER or time.monotonic() - began_s > patience_s:
                    answer.failure(why)
                    self.book.note(kinds.UNANSWERED, method=method, path=path, key=key, status=status)
                    raise GaveUp(why)
                answer.request_meta["name"] = f"again: {name}"
                answer.success()
                self.book.note(kinds.RETRIED, name=name, why=why)
                asked_s = float(answer.headers.get("Retry-After", "0") or 0) if answer.headers else 0.0
            gevent.sleep(min(max(asked_s, pause_s), 30.0))
            pause_s = min(2 * pause_s, MAX_PAUSE_S)

    def headers_for(self, method: str) -> dict[str, str]:
        return {}

    def note_visible(self, name: str, took_s: float) -> None:
        """What somebody waited for came; that is no request, and not among their times."""
        self.book.note(kinds.SEEN, name=name, took_s=round(took_s, 2))

    def blame(self, name: str, fault: Exception) -> None:
        """A failure that no answer's status tells: a wrong word in it, or what never came."""
        self.environment.events.request.fire(
            request_type="SEEN", name=name, response_time=0, response_length=0, exception=fault, context={}
        )


class Bearer(Client):
    """A program or a companion computer with a token."""

    abstract = True
    token = ""

    def headers_for(self, method: str) -> dict[str, str]:
        return {"Authorization": f"Bearer {self.token}"}


class Browser(Client):
    """Somebody who has signed in; asks for what did not change with the ETag that came with it."""

    abstract = True
    name = ""

    def on_start(self) -> None:
        self.tags: dict[str, str] = {}
        self.sign_in()

    def sign_in(self) -> None:
        """With the page and its form, from the beginning where the site says that it cannot just now."""
        began_s = time.monotonic()
        while not self._is_let_in(time.monotonic() - began_s < TIMEOUT_S):
            gevent.sleep(MAX_PAUSE_S)

    def _is_let_in(self, may_try_again: bool) -> bool:
        page = self.ask("GET", "/sign-in", "sign in: page")
        form = FORM_TOKEN.search(page.content)
        if form is None:
            raise GaveUp("no form to sign in with")
        body = {"csrfmiddlewaretoken": form[1].decode(), "login": self.name, "password": self.site.password, "next": "/"}
        headers = {"Referer": f"{self.host}/sign-in"}
        with self.client.post("/sign-in", name="sign in", data=body, headers=headers, catch_response=True, allow_redirects=False) as answer:
            if answer.status_code == 302:
                answer.success()
                return True
            why = f"answered {answer.status_code}"
            if answer.status_code in LATER and may_try_again:
                answer.request_meta["name"] = "again: sign in"
                answer.success()
                self.book.note(kinds.RETRIED, name="sign in", why=why)
                return False
            answer.failure(why)
        raise GaveUp("not signed in")

    def headers_for(self, method: str) -> dict[str, str]:
        if method not in UNSAFE:
            return {}
        return {"X-CSRFToken": self.cookie("csrftoken"), "Referer": f"{self.host}/", "Origin": str(self.host)}

    def cookie(self, name: str) -> str:
        """Its value; over TLS it has a prefix."""
        return next((str(cookie.value) for cookie in self.client.cookiejar if cookie.name.removeprefix("__Host-") == name), "")

    def cookies(self) -> str:
        """For a websocket."""
        return "; ".join(f"{cookie.name}={cookie.value}" for cookie in self.client.cookiejar)

    def look(self, path: str, name: str, ok: tuple[int, ...] = (200, 304)) -> Any:
        """As a browser asks again for what it has kept: 304 is an answer like another. None for 304."""
        tag = self.tags.get(path, "")
        answer = self.ask("GET", path, name, ok=ok, **({"If-None-Match": tag} if tag else {}))
        if answer.status_code == 304:
            return None
        if answer.headers.get("ETag"):
            self.tags[path] = answer.headers["ETag"]
        return answer

    def delete_mission(self, mission: str) -> bool:
        """Whether it is deleted. One that is not there any more was deleted by a try whose answer was lost."""
        self.book.note(kinds.ASKED, thing=mission)
        answer = self.ask("DELETE", f"/api/v1/missions/{mission}", "mission: delete", ok=(204, 404, 409), **{"If-Match": "*"})
        if answer.status_code != 409:
            self.book.note(kinds.DELETION, mission=mission)
        return bool(answer.status_code != 409)

    def get(self, path: str, name: str) -> Any:
        return self.ask("GET", f"/api/v1/{path}", name).json()
