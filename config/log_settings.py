"""How lines of log are written, from the environment: for people, or as JSON; see operation/json_lines.py."""

from collections.abc import Mapping
from typing import Any


def log_settings(environment: Mapping[str, str]) -> dict[str, Any]:
    """Django's LOGGING: everything to the console, in one of two forms."""
    form = "json" if environment.get("SPANWISE_LOG_FORMAT") == "json" else "line"
    return {
        "version": 1,
        "disable_existing_loggers": False,
        "formatters": {
            "line": {"()": "operation.json_lines.LineFormatter"},
            "json": {"()": "operation.json_lines.JsonFormatter", "program": environment.get("SPANWISE_PROGRAM", "")},
        },
        "handlers": {"console": {"class": "logging.StreamHandler", "formatter": form}},
        "root": {"handlers": ["console"], "level": environment.get("SPANWISE_LOG_LEVEL", "INFO")},
    }
