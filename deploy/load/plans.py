"""The article's operators in Locust: each asks for a plan, looks at it, waits, and asks again, in the shape of one scenario.

    locust -f deploy/load/plans.py ...      (deploy/load/run.py starts it, bounded in time, and reports)

A stated share of them signs in as people do, with the page, its CSRF token, a password and a session; the others carry tokens. Each has
an account of their own, and a connection that is kept. Every answer is noted: when, how long it took, and what was wrong with it.
"""

import os
import random
import time
from itertools import count
from pathlib import Path
from typing import Any

import gevent
import orjson
from locust import FastHttpUser, LoadTestShape, between, events, task
from locust.env import Environment

from deploy.load.answers import PLAN, Recorder
from deploy.load.kept_connections import keep_all_connections
from deploy.load.plan_answers import fault_of, fault_of_plan, plain_fault_of
from deploy.load.scenarios import RAMPS_TO_SCALE_BY, SCENARIOS
from deploy.load.trust import trusting

FOLDER = Path(os.environ["SPANWISE_LOAD_FOLDER"])  # what prepare_ground.py has written
RESULT = Path(os.environ["SPANWISE_LOAD_RESULT"])
SESSIONS = float(os.environ.get("SPANWISE_LOAD_SESSIONS", "0.05"))  # share of users who sign in
SCENARIO = (SCENARIOS | RAMPS_TO_SCALE_BY)[int(os.environ.get("SPANWISE_LOAD_SCENARIO", "4"))].scaled(
    users=float(os.environ.get("SPANWISE_LOAD_USERS", "1")), seconds=float(os.environ.get("SPANWISE_LOAD_SECONDS", "1"))
)
TARGETS = os.environ.get("SPANWISE_LOAD_BODIES", "missions.json")
BODIES = [(orjson.dumps(body), body) for body in orjson.loads((FOLDER / TARGETS).read_bytes())]
TOKENS = (FOLDER / "tokens.txt").read_text().split()
PASSWORD = (FOLDER / "password.txt").read_text()
READ_WHOLE_EVERY = 10
IS_LARGE = TARGETS.startswith("large")  # more targets than are planned while one waits
POLL_INTERVAL_S = 1.0
MAX_JOB_S = 300.0
_users, _bodies = count(), count()
recorder = Recorder(SCENARIO)
keep_all_connections()


class Shape(LoadTestShape):
    """Users as the scenario has them at this second."""

    def tick(self) -> tuple[int, float] | None:
        stage = SCENARIO.stage_at(self.get_run_time())
        recorder.note_users(self.get_current_user_count())
        return None if stage is None else (stage.users, stage.users_per_s)


class Operator(FastHttpUser):
    """Asks for a plan, checks that it is one, waits."""

    wait_time = between(*SCENARIO.wait_s)
    network_timeout = 60.0
    connection_timeout = 60.0
    max_retries = 0
    insecure = False
    ssl_context_factory = staticmethod(trusting(os.environ["SPANWISE_LOAD_AUTHORITY"]))

    def on_start(self) -> None:
        """Locust makes all users of a second at once; they come at moments of their own in it, or they would ask together ever after."""
        number = next(_users)
        gevent.sleep(random.random())
        signs_in = int((number + 1) * SESSIONS) > int(number * SESSIONS)  # evenly among those who come
        self.name = f"load-{number % len(TOKENS)}"
        self.headers: dict[str, str] = {"Content-Type": "application/json"}
        if not signs_in:
            self.headers["Authorization"] = f"Bearer {TOKENS[number % len(TOKENS)]}"
        self.is_in = not signs_in

    @task
    def plan(self) -> None:
        if not self.is_in and not self.sign_in():
            return
        turn = next(_bodies)
        sent, body = BODIES[turn % len(BODIES)]
        if IS_LARGE:
            self.large_plan(sent, body)
            return
        look = plain_fault_of if turn % READ_WHOLE_EVERY else fault_of
        with self.client.post("/api/v1/plans", data=sent, headers=self.headers, name=PLAN, catch_response=True) as answer:
            fault = f"answered {answer.status_code}" if answer.status_code != 200 else look(answer.content, body)
            if fault:
                answer.failure(fault)
            if answer.status_code in {401, 403} and "Authorization" not in self.headers:
                self.is_in = False  # the session has ended: this user signs in again

    def large_plan(self, sent: bytes, body: dict[str, Any]) -> None:
        """A worker's: asked for, and looked at each second until it is done. The whole time counts as the plan's."""
        began_s, fault = time.monotonic(), ""
        with self.client.post("/api/v1/plans", data=sent, headers=self.headers, name="ask", catch_response=True) as answer:
            if answer.status_code != 202:
                answer.failure(f"answered {answer.status_code}")
                return
            job = f"/api/v1/jobs/{orjson.loads(answer.content)['job']}"
        state = "queued"
        while not fault and state in {"queued", "running"}:
            gevent.sleep(POLL_INTERVAL_S)
            answer = self.client.get(job, headers=self.headers, name="look")
            if answer.status_code == 200:  # what is not is noted as a failure already, and asked again
                found = orjson.loads(answer.content)
                state = found["state"]
            if time.monotonic() - began_s > MAX_JOB_S:
                fault = f"not done after {MAX_JOB_S:.0f} s"
        if not fault:
            fault = fault_of_plan(found["result"], body) if state == "done" else f"{state}: {found['error']}"
        self.environment.events.request.fire(
            request_type="JOB",
            name=PLAN,
            response_time=1_000 * (time.monotonic() - began_s),
            response_length=0,
            exception=RuntimeError(fault) if fault else None,
            context={},
        )

    def sign_in(self) -> bool:
        """As the page does it. What goes wrong is a failure; then this user tries again after the wait."""
        page = self.client.get("/sign-in", name="sign-in page")
        if page.status_code != 200:
            return False
        form = {"login": self.name, "password": PASSWORD, "csrfmiddlewaretoken": self._csrf_token()}
        headers = {"Referer": f"{self.host}/sign-in"}
        with self.client.post("/sign-in", data=form, headers=headers, name="sign in", allow_redirects=False, catch_response=True) as answer:
            self.is_in = answer.status_code == 302
            if self.is_in:
                answer.success()
            else:
                answer.failure(f"not let in: {answer.status_code}")
        if self.is_in:
            self.headers |= {"X-CSRFToken": self._csrf_token(), "Referer": f"{self.host}/map"}
        return self.is_in

    def _csrf_token(self) -> str:
        return next((cookie.value or "" for cookie in self.client.cookiejar if cookie.name.endswith("csrftoken")), "")


@events.test_start.add_listener
def begin(environment: Environment, **_: Any) -> None:
    recorder.begin(time.time())


@events.request.add_listener
def note(name: str, response_time: float, exception: Exception | None, **_: Any) -> None:
    recorder.note_answer(name, response_time, exception)


@events.quitting.add_listener
def write(environment: Environment, **_: Any) -> None:
    recorder.write(RESULT)
