"""Loads of pages on a slow network and a small screen: when each can be used, its requests and its bytes.

    python -m benchmarks.page_loads --site http://127.0.0.1:8000 --password-file var/demo_password [--turns 5] [--processor 4]

The network is Chromium's emulation of slow 4G (150 ms, 1.6 Mbit/s down, 750 kbit/s up), the screen a phone's. A cold load begins with an
empty cache, a warm one follows it in the same browser. A page can be used once its script has drawn its data (`html[data-usable]`), and
is whole once its map has been drawn, too (`html[data-loaded]`).
Chromium does not slow down the workers that fetch tiles of the map. Requests and bytes are of what the page has fetched once it is idle.
"""

import argparse
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from playwright.sync_api import Browser, BrowserContext, CDPSession, Request, sync_playwright

from benchmarks.map_page import Installation, sign_in
from scripts.installation.system_packages import BROWSERS
from tests.browser.chromium import CHROMIUM_FLAGS

SLOW_4G = {"offline": False, "latency": 150, "downloadThroughput": 1_600_000 / 8, "uploadThroughput": 750_000 / 8}
# In every page, before its own scripts.
WATCH = """
(() => {
  const watched = (window.watched = { usable: null, whole: null });
  const look = () => {
    const { usable, loaded } = document.documentElement?.dataset ?? {};
    if (usable || loaded) watched.usable ??= performance.now();
    if (loaded) {
      watched.whole ??= performance.now();
      console.info("whole");
    } else setTimeout(look, 4);
  };
  look();
})();
"""
PHONE = {"width": 412, "height": 823}
LOAD_TIMEOUT_MS = 90_000
SETTLED_MS = 3_000  # after the last of all: lists of alerts, tiles


@dataclass(frozen=True)
class Load:
    usable_ms: float
    whole_ms: float
    requests: int
    bytes: float


@contextmanager
def slow_page(context: BrowserContext, processor: float) -> Iterator[tuple[Any, CDPSession]]:
    page = context.new_page()
    wire = context.new_cdp_session(page)
    wire.send("Network.enable")
    wire.send("Network.emulateNetworkConditions", SLOW_4G)
    wire.send("Emulation.setCPUThrottlingRate", {"rate": processor})
    yield page, wire
    page.close()


def load(context: BrowserContext, path: str, processor: float) -> Load:
    fetched: list[Request] = []
    with slow_page(context, processor) as (page, _):
        page.on("requestfinished", lambda request: None if request.url.startswith("data:") else fetched.append(request))
        # Nothing is evaluated in the page before it has settled: that counts as an act of the user.
        with page.expect_console_message(lambda message: message.text == "whole", timeout=LOAD_TIMEOUT_MS):
            page.goto(path, timeout=LOAD_TIMEOUT_MS, wait_until="commit")
        page.wait_for_timeout(SETTLED_MS)
        usable_ms, whole_ms = map(float, page.evaluate("[watched.usable, watched.whole]"))
        sizes = [request.sizes() for request in fetched]
    return Load(usable_ms, whole_ms, len(fetched), sum(size["responseHeadersSize"] + size["responseBodySize"] for size in sizes))


def measure(browser: Browser, site: Installation, state: dict[str, Any], path: str, *, turns: int, processor: float) -> None:
    cold, warm = [], []
    for _ in range(turns):
        context = browser.new_context(
            base_url=site.address, storage_state=state, viewport=PHONE, device_scale_factor=2, is_mobile=True, has_touch=True,
            service_workers="block",
        )  # type: ignore[arg-type]  # fmt: skip
        context.add_init_script(WATCH)
        cold.append(load(context, path, processor))
        warm.append(load(context, path, processor))
        context.close()
    name = "/missions/ID" if path.startswith("/missions/") else path
    for kind, loads in (("cold", cold), ("warm", warm)):
        usable_s, whole_s = ([getattr(one, moment) / 1_000 for one in loads] for moment in ("usable_ms", "whole_ms"))
        print(
            f"{name:12} {kind}  usable {median(usable_s):5.2f} s ({min(usable_s):.2f} to {max(usable_s):.2f})  "
            f"whole {median(whole_s):5.2f} s ({min(whole_s):.2f} to {max(whole_s):.2f})  "
            f"{median(one.requests for one in loads):4.0f} requests  {median(one.bytes for one in loads) / 1_000:6.0f} kB",
            flush=True,
        )


def a_mission(browser: Browser, site: Installation, state: dict[str, Any]) -> str:
    """Return the id of the mission with the most targets."""
    context = browser.new_context(base_url=site.address, storage_state=state)  # type: ignore[arg-type]
    rows = context.request.get("/api/v1/missions?limit=20").json()["results"]
    context.close()
    return str(max(rows, key=lambda row: (row.get("target_count", 0), row["id"]))["id"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--site", default="http://127.0.0.1:8000")
    parser.add_argument("--password-file", type=Path, default=Path("var/demo_password"))
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--processor", type=float, default=1.0, help="how many times slower the processor is to seem")
    parser.add_argument("--paths", nargs="*", help="instead of the plan of a mission, Live and Missions")
    parser.add_argument("--chromium", default=next(filter(None, map(shutil.which, BROWSERS)), None))
    options = parser.parse_args()
    site = Installation(options.site, int(options.site.rpartition(":")[2]), options.password_file.read_text().strip())
    with sync_playwright() as playwright:
        print(f"load of the machine before: {os.getloadavg()[0]:.1f}")
        browser = playwright.chromium.launch(executable_path=options.chromium, args=CHROMIUM_FLAGS)
        state = sign_in(browser, site)
        for path in options.paths or [f"/missions/{a_mission(browser, site, state)}", "/live", "/"]:
            measure(browser, site, state, path, turns=options.turns, processor=options.processor)
        browser.close()
        print(f"load of the machine after: {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
