"""What the supervisor gives to each program beside its command."""

from pathlib import Path

import pytest

from scripts.places import PROGRAMS_WITH_METRICS, Places
from scripts.supervision.programs import web_programs


@pytest.mark.parametrize(("of_the_site", "given"), [(None, "2"), ("8", "8")])
def test_each_takes_memory_from_two_pools_unless_the_site_says_otherwise(
    of_the_site: str | None, given: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.delenv("MALLOC_ARENA_MAX", raising=False)
    if of_the_site:
        monkeypatch.setenv("MALLOC_ARENA_MAX", of_the_site)
    pools = {program.name: program.environment.get("MALLOC_ARENA_MAX") for program in web_programs(Places(tmp_path), tmp_path)}
    assert {name: pools[name] for name in PROGRAMS_WITH_METRICS} == dict.fromkeys(PROGRAMS_WITH_METRICS, given)
