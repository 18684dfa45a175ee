"""What a release changes, and when there is none."""

import pytest

from scripts.development.release import CannotRelease, numbers, released_changelog, released_project

CHANGELOG = """# Changelog

## [Unreleased]

### Added
- Something.

## [0.1.0] - 2026-01-01
- The first.
"""


def test_what_is_unreleased_gets_its_version_and_day() -> None:
    text = released_changelog(CHANGELOG, "0.2.0", "2026-02-01")
    assert "## [0.2.0] - 2026-02-01\n\n### Added" in text
    assert "Unreleased" not in text
    assert "## [0.1.0] - 2026-01-01" in text


def test_a_version_that_is_named_and_unreleased_is_released_under_its_name() -> None:
    text = released_changelog("## [0.1.0] - unreleased\n- One.\n", "0.1.0", "2026-02-01")
    assert text == "## [0.1.0] - 2026-02-01\n- One.\n"


@pytest.mark.parametrize("text", ["# Changelog\n", "## [Unreleased]\n\n## [0.1.0] - 2026-01-01\n- The first.\n"])
def test_nothing_to_tell_is_no_release(text: str) -> None:
    with pytest.raises(CannotRelease):
        released_changelog(text, "0.2.0", "2026-02-01")


def test_versions_go_up() -> None:
    project = '[project]\nname = "spanwise"\nversion = "0.1.0"\n'
    assert 'version = "0.2.0"' in released_project(project, "0.2.0")
    assert released_project(project, "0.1.0") == project
    with pytest.raises(CannotRelease, match="older"):
        released_project(project, "0.0.9")


@pytest.mark.parametrize("version", ["1", "1.2", "v1.2.3", "1.2.3-rc1", "01.2.3", ""])
def test_what_is_no_version_is_refused(version: str) -> None:
    with pytest.raises(CannotRelease):
        numbers(version)
