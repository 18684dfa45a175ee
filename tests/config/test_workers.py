"""What a worker's process loads before its first task."""

from unittest import mock

import pytest

from config.celery import warm_up_process


@pytest.mark.parametrize(("queues", "times"), [({"simulation"}, 0), ({"planning"}, 1), ({"simulation", "planning"}, 1), ({"data"}, 0)])
def test_only_a_worker_that_makes_plans_loads_what_they_are_made_with(queues: set[str], times: int) -> None:
    with mock.patch("config.celery.app") as app, mock.patch("missions.services.warm_up") as warm_up:
        app.amqp.queues.consume_from = dict.fromkeys(queues)
        warm_up_process()
    assert warm_up.call_count == times
