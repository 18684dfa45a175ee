"""docs/api.md: its examples run as they stand, against the real server, worker's code and websocket."""

import re
from datetime import timedelta
from pathlib import Path
from typing import Any
from unittest import mock

import pytest
from django.conf import settings
from django.utils import timezone

from inspection.tasks import apply_proposal, read_proposal
from missions.tasks import plan_campaign, solve_plan
from tests.accounts.users import a_user
from tests.missions.worlds import world
from tests.telemetry.live.conftest import closed_endpoint, endpoint, here, live_program, without_redis
from tests.workspace.live.proxied_site import Endpoint
from workspace.api_tokens import create_api_token
from workspace.models import Role

__all__ = ["closed_endpoint", "endpoint", "here", "live_program", "without_redis"]
pytestmark = pytest.mark.django_db(transaction=True)
DOCUMENT = Path(settings.BASE_DIR) / "docs" / "api.md"
SECTIONS = [
    "Token",
    "Paging",
    "Errors",
    "Retries",
    "If-Match",
    "Lines",
    "External ids",
    "Results",
    "Alerts",
    "Event log",
    "Jobs",
    "Campaigns",
    "Uploads",
    "Live feed",
]


def examples() -> dict[str, str]:
    """Return the Python of each section."""
    sections = re.split(r"^## ", DOCUMENT.read_text(), flags=re.MULTILINE)[1:]
    found = {section.partition("\n")[0]: "\n".join(re.findall(r"```python\n(.*?)```", section, re.DOTALL)) for section in sections}
    return {title: code for title, code in found.items() if code}


TASKS = {f"{task.__module__}.{task.__name__}": task for task in (solve_plan, plan_campaign, read_proposal, apply_proposal)}


def run_here(task: str, *, args: list[str], retry: bool) -> None:
    TASKS[task](*args)


@pytest.mark.long
def test_every_example_of_the_document_runs(live_server: Any, here: Endpoint) -> None:
    world()
    token = create_api_token(user=a_user(Role.ADMINISTRATOR), name="example", expires_at=timezone.now() + timedelta(hours=1))
    assert list(examples()) == SECTIONS
    names: dict[str, Any] = {}
    with mock.patch("workspace.tasks.current_app.send_task", side_effect=run_here):
        for title, code in examples().items():
            own = code.replace("http://127.0.0.1:8000", live_server.url).replace("spw_...", token)
            if title == "Live feed":
                names["SERVER"] = f"http://127.0.0.1:{here.port}"
            exec(compile(own, f"docs/api.md, {title}", "exec"), names)  # noqa: S102 - our own document
    assert names["status"] == 200 or names["shown"]
