"""Lighthouse's scores of the core pages on a phone. It has 150 packages, so it is installed by its first run, for --long alone."""

import json
import shutil
import socket
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext

from scripts.installation.system_packages import BROWSERS
from tests.browser.chromium import CHROMIUM_FLAGS
from tests.browser.conftest import PROJECT_DIR, Site, Visitor
from tests.browser.operator_map import stores_mission

pytestmark = [pytest.mark.browser, pytest.mark.long]

SOURCES = Path(__file__).parent
FOLDER = PROJECT_DIR / ".cache" / "lighthouse"
PACKAGES = ("package.json", "package-lock.json")
PAGES = {"missions": "/", "plan": "", "live": "/live", "assets": "/assets", "zones": "/zones", "fleet": "/uavs"}
TIMEOUT_S = 180
# Of 100. Some 7 below what was measured on 2 cores that also ran other tests; maps are drawn without a graphics card.
MIN_PERFORMANCE = {"missions": 92, "plan": 40, "live": 50, "assets": 52, "zones": 52, "fleet": 92}
MIN_BEST_PRACTICES = 100


@pytest.fixture(scope="module")
def program() -> Path:
    """Lighthouse's command, installed where it is missing or of another version."""
    command = FOLDER / "node_modules" / "lighthouse" / "cli" / "index.js"
    FOLDER.mkdir(parents=True, exist_ok=True)
    if not command.exists() or any((FOLDER / name).read_bytes() != (SOURCES / name).read_bytes() for name in PACKAGES):
        for name in PACKAGES:
            shutil.copy2(SOURCES / name, FOLDER)
        install = ["npm", "ci", "--prefer-offline", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error"]
        subprocess.run(install, cwd=FOLDER, check=True, timeout=300)  # noqa: S603
    return command


@pytest.fixture
def debugging(chromium: Browser, visitor: Visitor, site: Site, tmp_path: Path) -> Iterator[tuple[int, BrowserContext]]:
    """A browser whose first context is signed in, and the port at which Lighthouse opens pages in it."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = int(probe.getsockname()[1])
    page = visitor.signs_in("opal")
    context = chromium.browser_type.launch_persistent_context(
        tmp_path / "profile",
        executable_path=next(filter(None, map(shutil.which, BROWSERS))),
        args=[*CHROMIUM_FLAGS, f"--remote-debugging-port={port}"],
        base_url=site.address,
    )
    context.add_cookies(page.context.cookies())  # type: ignore[arg-type]
    yield port, context
    context.close()


def scores(program: Path, address: str, port: int) -> tuple[dict[str, int], list[str]]:
    """Return the score of each category, and the audits of accessibility and best practices that failed."""
    options = ["--only-categories=performance,accessibility,best-practices", "--disable-storage-reset", "--output=json", "--quiet"]
    command = ["node", program, address, f"--port={port}", *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)  # noqa: S603
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert report["finalDisplayedUrl"].partition("#")[0] == address, "not the page itself, but another one to which it led"
    rated = {ref["id"] for name in ("accessibility", "best-practices") for ref in report["categories"][name]["auditRefs"] if ref["weight"]}
    failed = [f"{name}: {audit['title']}" for name, audit in report["audits"].items() if name in rated and audit["score"] == 0]
    return {name: round(100 * category["score"]) for name, category in report["categories"].items()}, failed


@pytest.mark.parametrize("name", PAGES)
def test_a_core_page_has_its_scores(name: str, program: Path, debugging: tuple[int, BrowserContext], site: Site) -> None:
    port, context = debugging
    path = PAGES[name] or stores_mission(context.pages[0], "Measured by Lighthouse")
    found, failed = scores(program, f"{site.address}{path}", port)
    print(name, found)
    assert found["accessibility"] == 100, failed
    assert found["best-practices"] >= MIN_BEST_PRACTICES, failed
    assert found["performance"] >= MIN_PERFORMANCE[name], found
