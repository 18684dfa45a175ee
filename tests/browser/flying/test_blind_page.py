"""A live page that gets no data: it says so itself, in time and with the right time, whether its line is cut or frozen."""

import re
import time

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import Site, Visitor
from tests.browser.flying.frozen_line import line_to

pytestmark = pytest.mark.browser

DESK, PHONE = (1440, 900), (390, 844)
OTHERS = [("cut", DESK), ("freeze", PHONE), ("freeze", DESK)]
WITHIN_S = 6.0
BETWEEN_HEARTBEATS_S = 3.0  # and the page's clock is the server's within a second


@pytest.mark.parametrize(
    ("fault", "size"),
    [("cut", PHONE), *(pytest.param(*case, marks=pytest.mark.long) for case in OTHERS)],
)
def test_a_page_without_data_says_so_within_6_s(fault: str, size: tuple[int, int], visitor: Visitor, site: Site) -> None:
    page = visitor.signs_in("opal", size=size, touch=size[0] < 500)
    with line_to(site.address) as line:
        address = line.address
        page.goto(f"{line.address}/live")
        expect(page.locator("html[data-loaded][data-link=whole]")).to_be_attached()
        stale = page.locator("#stale")
        expect(stale).to_be_hidden()
        getattr(line, fault)()
        stopped_s, stopped_at_s = time.monotonic(), time.time()
        expect(stale).to_contain_text("No data on this device for 5 s.")
        took_s = time.monotonic() - stopped_s
        stated = stale.inner_text()
        line.repair()
        expect(stale).to_be_hidden()
    page.context.close()
    visitor.complaints.clear()  # of a line that was cut
    visitor.requests_outside[:] = [url for url in visitor.requests_outside if not url.startswith(address)]
    assert took_s <= WITHIN_S
    minutes, seconds = map(int, re.search(r"Last message \d\d:(\d\d):(\d\d)", stated).groups())  # type: ignore[union-attr]
    ago_s = (stopped_at_s - (minutes * 60 + seconds)) % 3600
    assert ago_s <= BETWEEN_HEARTBEATS_S or ago_s >= 3600 - 1, f"{stated!r}, {ago_s:.1f} s before the line stopped"


def test_the_bell_and_its_count_are_on_every_page(visitor: Visitor) -> None:
    page = visitor.signs_in("opal")
    for path in ("/", "/missions/new", "/assets", "/zones", "/uavs", "/account", "/live"):
        page.goto(path)
        expect(page.locator("#open-alerts")).to_have_count(1)
        expect(page.locator("#open-alerts")).to_be_visible()
