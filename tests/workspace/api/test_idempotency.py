"""A POST with an Idempotency-Key happens once."""

import json
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from typing import Any

import pytest
from django.db import connection
from django.test import Client
from django.utils import timezone

from tests.accounts.users import a_user, client_of
from workspace.jobs.services import forget_old_idempotency_keys
from workspace.models import IdempotencyKey, Organisation

pytestmark = [pytest.mark.django_db, pytest.mark.urls("tests.workspace.api.echo_urls")]


def create(client: Client, key: str | None = "k", **body: str) -> Any:
    headers = {} if key is None else {"Idempotency-Key": key}
    return client.post("/api/v1/create", json.dumps(body), content_type="application/json", headers=headers)


def made(name: str) -> int:
    return Organisation.objects.filter(name__startswith=name).count()


def test_the_second_request_gets_the_first_answer() -> None:
    client = client_of(a_user())
    first, second = create(client, name="North"), create(client, name="North")
    assert (first.status_code, first.json(), first["Location"]) == (second.status_code, second.json(), second["Location"])
    assert second["Idempotency-Replayed"] == "true"
    assert made("North") == 1


def test_the_key_belongs_to_one_request() -> None:
    client = client_of(a_user())
    create(client, name="North")
    answer = create(client, name="South")
    assert answer.status_code == 422
    assert answer.json()["error"]["code"] == "idempotency_conflict"
    assert made("South") == 0


def test_the_key_belongs_to_one_user() -> None:
    assert create(client_of(a_user()), name="North").status_code == 201
    assert create(client_of(a_user()), name="South").status_code == 201


@pytest.mark.parametrize("fail", ["raise", "return"])
def test_a_request_that_failed_leaves_nothing_and_can_be_sent_again(fail: str) -> None:
    client = client_of(a_user())
    assert create(client, name="North", fail=fail).status_code in {409, 500}
    assert made("North") == IdempotencyKey.objects.count() == 0
    assert create(client, name="North").status_code == 201


@pytest.mark.parametrize("key", ["", "x" * 201, "ä"])
def test_a_key_that_cannot_be_kept_is_refused(key: str) -> None:
    assert create(client_of(a_user()), key=key, name="North").status_code == 400


def test_without_a_key_nothing_is_kept() -> None:
    assert create(client_of(a_user()), key=None, name="North").status_code == 201
    assert not IdempotencyKey.objects.exists()


@pytest.mark.django_db(transaction=True)
def test_two_requests_at_the_same_moment_create_once() -> None:
    user = a_user()

    def send(number: int) -> tuple[int, bytes]:
        try:
            answer = create(client_of(user), name="North")
            return answer.status_code, answer.content
        finally:
            connection.close()

    with ThreadPoolExecutor(4) as pool:
        answers = set(pool.map(send, range(8)))
    assert len(answers) == 1
    assert answers.pop()[0] == 201
    assert made("North") == 1


def test_keys_are_forgotten_after_two_days() -> None:
    client = client_of(a_user())
    create(client, name="North")
    assert forget_old_idempotency_keys() == 0
    IdempotencyKey.objects.update(created_at=timezone.now() - timedelta(hours=49))
    assert forget_old_idempotency_keys() == 1
