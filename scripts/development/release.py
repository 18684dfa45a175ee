"""Make a release: the version, the changelog's heading and a tag, in one commit. You push it, which starts the pipeline.

scripts/release 0.2.0 [--dry-run]
"""

import argparse
import re
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

PROJECT_DIR = Path(__file__).resolve().parents[2]  # works without .venv
VERSION = re.compile(r"(0|[1-9]\d*)\.(0|[1-9]\d*)\.(0|[1-9]\d*)")
IN_PROJECT = re.compile(r'^version = "(?P<version>[^"]+)"$', re.MULTILINE)
UNRELEASED = re.compile(r"^## \[(?P<name>[^\]]+)\](?P<rest>.*unreleased.*)?$", re.MULTILINE | re.IGNORECASE)
IN_OVERLAY = re.compile(r"(newName: registry\.example\.org/spanwise, newTag: )[^}\s]+")
OVERLAYS = "deploy/kubernetes/overlays/*/kustomization.yaml"


class CannotRelease(Exception):
    """Raised when a release is not possible, with the reason."""


def numbers(version: str) -> tuple[int, int, int]:
    """Return the three numbers of a semantic version. Raises CannotRelease for anything else."""
    match = VERSION.fullmatch(version)
    if match is None:
        raise CannotRelease(f"{version!r} is no version: three numbers with dots between them are")
    first, second, third = (int(part) for part in match.groups())
    return first, second, third


def released_project(text: str, version: str) -> str:
    """Return pyproject.toml with the new version, which may not be lower. Raises CannotRelease."""
    match = IN_PROJECT.search(text)
    if match is None:
        raise CannotRelease("pyproject.toml names no version")
    if numbers(version) < numbers(match["version"]):
        raise CannotRelease(f"{version} is older than {match['version']}")
    return text[: match.start("version")] + version + text[match.end("version") :]


def released_changelog(text: str, version: str, day: str) -> str:
    """Return the changelog with version and day on its unreleased section. Raises CannotRelease where that is missing or empty."""
    heading = UNRELEASED.search(text)
    if heading is None or not (heading["rest"] or heading["name"].lower() == "unreleased"):
        raise CannotRelease("CHANGELOG.md has no heading [Unreleased]: write down first what people will notice")
    following = re.compile(r"^## ", re.MULTILINE).search(text, heading.end())
    if "- " not in text[heading.end() : following.start() if following else len(text)]:
        raise CannotRelease("CHANGELOG.md says nothing under [Unreleased]")
    return f"{text[: heading.start()]}## [{version}] - {day}{text[heading.end() :]}"


def _git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=PROJECT_DIR, capture_output=True, text=True, check=True).stdout.strip()


def release(version: str, *, is_dry: bool) -> list[str]:
    """Write the release and return the changed paths; unless it is dry, also commit and tag."""
    numbers(version)
    if _git("tag", "--list", f"v{version}"):
        raise CannotRelease(f"v{version} is released already")
    if not is_dry and _git("status", "--porcelain"):
        raise CannotRelease("there are changes that are not committed")
    project, changelog = PROJECT_DIR / "pyproject.toml", PROJECT_DIR / "CHANGELOG.md"
    new = {
        project: released_project(project.read_text(), version),
        changelog: released_changelog(changelog.read_text(), version, datetime.now(UTC).date().isoformat()),
    }
    new |= {path: IN_OVERLAY.sub(rf"\g<1>{version}", path.read_text()) for path in sorted(PROJECT_DIR.glob(OVERLAYS))}
    changed = {path: text for path, text in new.items() if text != path.read_text()}
    names = [str(path.relative_to(PROJECT_DIR)) for path in changed]
    if not is_dry:
        _write(changed)
        _git("commit", "--quiet", "--message", f"Release {version}", "--", *names)
        _git("tag", "--annotate", "--message", f"Spanwise {version}", f"v{version}")
    return names


def _write(changed: dict[Path, str]) -> None:
    for path, text in changed.items():
        path.write_text(text)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("version")
    parser.add_argument("--dry-run", action="store_true", help="only say what would change")
    options = parser.parse_args(arguments)
    try:
        names = release(options.version, is_dry=options.dry_run)
    except CannotRelease as error:
        print(f"No release: {error}", file=sys.stderr)
        return 1
    print(f"{'would change' if options.dry_run else 'changed'} {', '.join(names)}")
    if not options.dry_run:
        print(f"Committed and tagged. Run ./check on it, then: git push --follow-tags origin HEAD v{options.version}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
