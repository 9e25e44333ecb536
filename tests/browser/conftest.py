"""Laboratories, networks and watchers, which end with their test."""

from contextlib import contextmanager
from shutil import which

import pytest
from playwright.sync_api import sync_playwright

from laboratory import Laboratory
from network import Network
from watching import live, watch


@contextmanager
def launched():
    """Run Debian's Chromium without a window."""
    path = which("chromium")
    assert path, "no chromium is on the PATH"
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=path)
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def chromium():
    """Have one browser for all tests."""
    with launched() as browser:
        yield browser


@pytest.fixture
def make_laboratory(tmp_path):
    """Make laboratories."""
    made = []

    def make(**words):
        folder = tmp_path / f"laboratory-{len(made)}"
        folder.mkdir()
        made.append(Laboratory(folder, **words))
        return made[-1]

    yield make
    for laboratory in made:
        laboratory.end()


@pytest.fixture
def laboratory(make_laboratory):
    """Have one pump, `acid`."""
    return make_laboratory()


@pytest.fixture
def service(laboratory):
    """Have the service of `laboratory`."""
    return laboratory.serve()


@pytest.fixture
def make_network():
    """Make networks between a page and a service."""
    made = []

    def make(service):
        made.append(Network(service))
        return made[-1]

    yield make
    for network in made:
        network.end()


@pytest.fixture
def open_page(chromium):
    """Open pages. Each must end without an error in its console."""
    pages = []

    def opened(url, is_live=True, **options):
        pages.append(watch(chromium, url, **options))
        return live(pages[-1]) if is_live else pages[-1]

    yield opened
    faults = [fault for page in pages for fault in page.faults]
    for page in pages:
        page.context.close()
    assert not faults
