"""Removal of secrets from logs."""

import re
from collections.abc import Callable

HIDDEN = "..."

# Tokens of users and UAVs begin with spw_ and spu_; MAVLink's signing keys are 64 hexadecimal digits behind a word for them.
_RULES: tuple[tuple[re.Pattern[str], str | Callable[[re.Match[str]], str]], ...] = (
    (re.compile(r"(/(?:new-password|invitation|email-address)/)[^\s\"'?]+"), r"\1" + HIDDEN),
    (re.compile(r"(/single-sign-on/callback\?)[^\s\"']+"), r"\1" + HIDDEN),
    (re.compile(r"(?i)\b(bearer|basic)\s+[A-Za-z0-9._~+/=-]{8,}"), r"\1 " + HIDDEN),
    (re.compile(r"\b(sp[wu]_)[A-Za-z0-9_-]{8,}"), r"\1" + HIDDEN),
    (re.compile(r"(?i)\b((?:sessionid|csrftoken|spanwise_known)\s*[=:]\s*)[^\s;,\"']+"), r"\1" + HIDDEN),
    (re.compile(r"(://[^\s:/@]*:)[^\s@/]+(@)"), r"\1" + HIDDEN + r"\2"),
    (
        re.compile(r"(?i)(['\"]?\b[\w-]*(?:password|passwd|secret|token|signing_?key|api_?key|csrfmiddlewaretoken)\w*['\"]?\s*[=:]\s*)"
                   r"(?:'[^']*'|\"[^\"]*\"|[^\s,;&)}\]]+)"),
        r"\1" + HIDDEN,
    ),
)  # fmt: skip
_HINT = re.compile(
    r"(?i)(?:new-password|invitation|email-address)/|callback\?|sp[wu]_|bearer|basic|sessionid|csrf|spanwise_known|://|passw|secret|token|key"
)


def without_secrets(text: str) -> str:
    """Return the text without recognisable secrets."""
    if _HINT.search(text) is None:
        return text
    for pattern, instead in _RULES:
        text = pattern.sub(instead, text)
    return text
