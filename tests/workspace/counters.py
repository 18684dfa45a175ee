"""The counts of requests in Redis, which outlive a test and its users."""

from workspace.api.throttling import _counters


def forget_counts() -> None:
    counters = _counters()
    for key in counters.scan_iter("throttle_*"):
        counters.delete(key)
