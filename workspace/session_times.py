"""When a session ends: a fixed time after signing in, after nobody was there, or after somebody only watched for long."""

from dataclasses import dataclass
from datetime import datetime, timedelta


@dataclass(frozen=True)
class SessionRules:
    longest_s: float  # from signing in, whatever is done
    idle_s: float  # without any open page
    watching_s: float  # with an open page in which nobody does anything


def ends_at(*, began_at: datetime, acted_at: datetime, present_at: datetime, rules: SessionRules) -> datetime:
    """The first of the three ends. `acted_at`: somebody opened or sent something; `present_at`: an open page was heard of."""
    present_at = max(present_at, acted_at)
    return min(
        began_at + timedelta(seconds=rules.longest_s),
        present_at + timedelta(seconds=rules.idle_s),
        acted_at + timedelta(seconds=rules.watching_s),
    )
