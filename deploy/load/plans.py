"""The article's scenario 4: operators who each ask for a plan, wait ten seconds, and ask again.

    locust -f deploy/load/plans.py ...      (deploy/load/run.py starts it, bounded in time, and reports)

Each user has a token of their own; the bodies are those of prepare_ground.py: 2 UAVs, 4 targets.
"""

import os
from itertools import count
from pathlib import Path

import orjson
from locust import FastHttpUser, constant, task

FOLDER = Path(os.environ["SPANWISE_LOAD_FOLDER"])
LOCUSTS = int(os.environ.get("SPANWISE_LOAD_LOCUSTS", "1"))  # processes, each with users of its own
WAIT_S = float(os.environ.get("SPANWISE_LOAD_WAIT_S", "10"))
BODIES = [orjson.dumps(body) for body in orjson.loads((FOLDER / "missions.json").read_bytes())]
TOKENS = (FOLDER / "tokens.txt").read_text().split()
_users, _bodies = count(), count()


class Operator(FastHttpUser):
    """Asks for a plan, checks that it is one, waits."""

    wait_time = constant(WAIT_S)
    network_timeout = 60.0
    connection_timeout = 60.0
    max_retries = 0

    def on_start(self) -> None:
        process = max(0, getattr(self.environment.runner, "worker_index", 0))
        token = TOKENS[(process + LOCUSTS * next(_users)) % len(TOKENS)]
        self.headers = {"Authorization": f"Bearer {token}", "Content-Type": "application/json"}

    @task
    def plan(self) -> None:
        body = BODIES[next(_bodies) % len(BODIES)]
        with self.client.post("/api/v1/plans", data=body, headers=self.headers, catch_response=True) as answer:
            if answer.status_code != 200:
                answer.failure(f"answered {answer.status_code}")
            elif b'"routes":' not in answer.content or b'"unassigned":[]' not in answer.content:
                answer.failure("not a whole plan")
