"""Results of jobs in the reader's language: workers store them in English."""

from typing import Any

from django.utils.module_loading import import_string

_functions: dict[str, str] = {}


def register_result_texts(task: str, function: str) -> None:
    """Register a function by its dotted name. It returns a result of this task with its texts in the active language."""
    _functions[task] = function


def result_with_texts(task: str, result: Any) -> Any:
    return import_string(_functions[task])(result) if result and task in _functions else result
