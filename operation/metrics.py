"""All metrics of Spanwise: names, labels and buckets. Labels take few values, and never identify a user or a row.

Counting takes microseconds and is always on; exposition.py serves the values.
"""

import os
from pathlib import Path

PROCESSES_FOLDER = "PROMETHEUS_MULTIPROC_DIR"  # prometheus_client's own: where processes of one program share metrics
if PROCESSES_FOLDER in os.environ:
    Path(os.environ[PROCESSES_FOLDER]).mkdir(parents=True, exist_ok=True)  # before the first metric opens its file there

from prometheus_client import Counter, Gauge, Histogram, disable_created_metrics  # noqa: E402 (after the folder)

disable_created_metrics()  # a third of the lines, and unused

REQUEST_BUCKETS_S = (0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0)
PLAN_BUCKETS_S = (0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 20.0, 60.0, 300.0)
TASK_BUCKETS_S = (0.01, 0.05, 0.1, 0.5, 1.0, 5.0, 10.0, 30.0, 60.0, 300.0, 900.0)
ROUND_BUCKETS_S = (0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 5.0)
ERROR_BUCKETS_M = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 400.0)

# Program web: requests, and plans made within them.
REQUESTS = Counter("spanwise_http_requests", "Requests that were answered", ["route", "method", "status"])
REQUEST_SECONDS = Histogram("spanwise_http_request_seconds", "From a request to its answer", ["route", "method"], buckets=REQUEST_BUCKETS_S)
PLANS = Counter("spanwise_plans", "Plans that were worked out, by targets asked for and how", ["size", "method"])
PLAN_SECONDS = Histogram("spanwise_plan_seconds", "To work a plan out", ["size", "method"], buckets=PLAN_BUCKETS_S)
PLANS_REFUSED = Counter("spanwise_plans_refused", "Plans that could not be made", ["reason"])

# Workers.
TASKS = Counter("spanwise_tasks", "Tasks that have ended", ["task", "outcome"])
TASK_SECONDS = Histogram("spanwise_task_seconds", "From the start of a task to its end", ["task"], buckets=TASK_BUCKETS_S)

# Program live.
WEBSOCKETS = Gauge("spanwise_websocket_clients", "Pages that listen", ["kind"], multiprocess_mode="livesum")
WEBSOCKET_MESSAGES = Counter("spanwise_websocket_messages", "Messages to pages", ["kind"])

# Program estimator. An error is the distance between a report and the estimate for its time.
ESTIMATOR_ROUND_SECONDS = Histogram("spanwise_estimator_round_seconds", "One look at every UAV that is held", buckets=ROUND_BUCKETS_S)
ESTIMATOR_ERROR_M = Histogram(
    "spanwise_estimator_error_metres", "Between a reported place and the one estimated for its moment", buckets=ERROR_BUCKETS_M
)
ESTIMATOR_INNOVATIONS = Counter("spanwise_estimator_innovations", "Reports, by whether they lay within the bound of 95 in 100", ["bound"])
ESTIMATED_UAVS = Gauge("spanwise_estimator_uavs", "UAVs that a watch holds", ["state"], multiprocess_mode="livesum")

BUILD = Gauge("spanwise_build", "Always 1; says which version runs", ["version", "program"], multiprocess_mode="livemax")
