"""What a worker's process loads before its first task."""

from unittest import mock

import pytest

from config.celery import app, warm_up_process


@pytest.mark.parametrize(
    ("queues", "times"), [({"simulation"}, 0), ({"planning"}, 1), ({"simulation", "planning"}, 1), ({"data"}, 0), ({"flight"}, 0)]
)
def test_only_a_worker_that_makes_plans_loads_what_they_are_made_with(queues: set[str], times: int) -> None:
    with mock.patch("config.celery.app") as app, mock.patch("missions.services.warm_up") as warm_up:
        app.amqp.queues.consume_from = dict.fromkeys(queues)
        warm_up_process()
    assert warm_up.call_count == times


@pytest.mark.parametrize(
    "task", ["missions.tasks.start_in_planned_order", "missions.tasks.expire_commands", "telemetry.tasks.settle_command_alerts"]
)
def test_what_uavs_on_a_mission_wait_for_waits_for_no_import_and_no_plan(task: str) -> None:
    def queue_of(name: str) -> str:
        return app.amqp.router.route({}, name)["queue"].name

    others = (
        "inspection.tasks.read_proposal",
        "inspection.tasks.refresh_graph",
        "missions.tasks.plan_mission",
        "simulation.tasks.rehearse_mission",
    )
    assert queue_of(task) not in {queue_of(name) for name in others}
