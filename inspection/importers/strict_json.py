"""Standard JSON: no NaN, no Infinity, no number too large for a float, limited nesting."""

import json
from math import isfinite
from typing import Any, NoReturn

from operation.reasons import Reason

MAX_DEPTH = 64


class JsonFault(ValueError):
    """Raised for text that is not acceptable JSON; the message has the place and the reason."""


class NotANumber(Exception):
    """Raised by STRICT_DECODER for NaN and Infinity; the message is their text."""


def _not_a_number(text: str) -> NoReturn:
    raise NotANumber(text)


STRICT_DECODER = json.JSONDecoder(parse_constant=_not_a_number)


def parse_strict_json(data: bytes | str, *, max_bytes: int, max_depth: int = MAX_DEPTH) -> Any:
    """Return the value of a JSON text in UTF-8; a byte-order mark is allowed. Raises JsonFault."""
    if len(data) > max_bytes:
        raise JsonFault(f"The file has {len(data) / 2**20:.1f} MiB; at most {max_bytes / 2**20:.0f} MiB are read.")
    try:
        text = data.decode("utf-8-sig") if isinstance(data, bytes) else data
        value = json.loads(text, parse_constant=_refuse_constant, parse_float=_finite)
    except UnicodeDecodeError as error:
        raise JsonFault(Reason("no_utf8", {"byte": error.start})) from error
    except RecursionError as error:
        raise JsonFault(f"The JSON is nested more than {max_depth} deep.") from error
    except JsonFault:
        raise
    except json.JSONDecodeError as error:
        raise JsonFault(Reason("no_json", {"error": f"{error.msg} at line {error.lineno}, column {error.colno}."})) from error
    except ValueError as error:
        raise JsonFault(Reason("no_json", {"error": str(error)})) from error
    _check_depth(value, max_depth)
    return value


def can_be_stored(value: Any) -> bool:
    """Whether PostgreSQL's jsonb can store it: no null characters, no unpaired surrogates."""
    text = json.dumps(value, ensure_ascii=False)
    return "\\u0000" not in text and not any("\ud800" <= character <= "\udfff" for character in text)


def _refuse_constant(text: str) -> NoReturn:
    raise JsonFault(f"{text} is no number in JSON.")


def _finite(text: str) -> float:
    number = float(text)
    if not isfinite(number):
        raise JsonFault(f"The number {text[:40]} is too large.")
    return number


def _check_depth(value: Any, max_depth: int) -> None:
    """Check the depth level by level, without recursion."""
    level = [value]
    for _ in range(max_depth + 1):
        holders = [item for item in level if isinstance(item, dict | list)]
        if not holders:
            return
        level = [child for holder in holders for child in (holder.values() if isinstance(holder, dict) else holder)]
    raise JsonFault(f"The JSON is nested more than {max_depth} deep.")
