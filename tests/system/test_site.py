"""The documentation builds as `make docs` builds it: strictly, and to all that it has to hold."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.browser import CHROMIUM
from support.driven_browser import driven_browser
from support.in_process import spring
from support.pages.job import small_job
from support.paths import ROOT

sys.path.append(str(ROOT / "docs" / "_ext"))

LINK = re.compile(r"\]\(([^)#:\s]+)[^)\s]*\)|(?:href|src)=\"([^\"#:]+)\"")


def site(docs: Path, out: Path, *more: str) -> subprocess.CompletedProcess[str]:
    """Build docs/ with the options of the Makefile."""
    (options,) = re.findall(r"sphinx-build (-.*?) -d", (ROOT / "Makefile").read_text())
    places = ("-d", out / "doctrees", docs, out / "html")
    command = [sys.executable, "-m", "sphinx", *options.split(), *more, *places]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built once."""
    out = tmp_path_factory.mktemp("site")
    done = site(ROOT / "docs", out)
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    return out / "html"


@pytest.mark.slow
def test_it_fetches_nothing_and_every_page_is_reached(pages: Path) -> None:
    fetched = r'<(?:link|script|img)[^>]*(?:src|href)="(?:https?:)?//'
    for file in pages.rglob("*.html"):
        assert "_downloads" in file.parts or not re.search(fetched, file.read_text()), file
    made = {str(file.relative_to(pages).with_suffix(".md")) for file in pages.rglob("*.html")}
    written = {str(page.relative_to(ROOT / "docs")) for page in (ROOT / "docs").rglob("*.md")}
    assert set(written) <= made


WIDTHS = (400, 1024, 1100, 1199, 1366, 1440, 1600)  # px, each side of where the theme changes


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no chromium on PATH")
def test_no_page_is_wider_than_the_window(
    pages: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither of the site, nor the report."""
    small_job(tmp_path)
    monkeypatch.chdir(tmp_path)
    for command in (
        "emit --scene scene.toml --out c",
        "validate c --recording validation",
        "report c",
    ):
        done = spring(*command.split())
        assert done.returncode == 0, done.stderr
    made = [tmp_path / "c" / "report.html"]
    shown = [*made, *(page for page in pages.rglob("*.html") if "_static" not in page.parts)]
    with driven_browser(tmp_path) as browser:
        for page in shown:
            for width in WIDTHS:
                browser.open(page.as_uri(), width)
                browser.until("document.readyState === 'complete'")
                wide = browser.value("document.documentElement.scrollWidth")
                assert wide <= width, f"{page.name} at {width} px"


# What is done to a copy of docs/, and a part of what the build has to say.
DEFECTS = {
    "a page that is gone": ("how-to/record.md", "](force-sensor.md)", "](force-sensors.md)",
                            "cross-reference target not found: 'force-sensors.md'"),
    "an anchor that is gone": ("how-to/record.md", "#protocols-of-record", "#protocols",
                               "local id not found"),
    "a file that is gone": ("how-to/own-device.md", "(../../runtime_c/port/posix/sp_link_serial.c)",
                            "(../../runtime_c/port/posix/sp_link_serials.c)",
                            "cross-reference target not found"),
    "a page in no list": ("how-to/index.md", "\nodrive\n", "\n", "document isn't included in any"),
    "an option that is gone": ("how-to/record.md", "# Record an object",
                               "# Record\n\n{option}`springpot train --modell`",
                               "unknown option: 'springpot train --modell'"),
    "a function that is gone": ("reference/c.md", "# C interface", "# C\n\n{c:func}`sp_stop`",
                                "c:func reference target not found: sp_stop"),
    "a name of Python that is gone": ("reference/python.md", "# Python",
                                      "# Python\n\n{py:func}`springpot.fit`",
                                      "py:func reference target not found: springpot.fit"),
    "a generator that is gone": ("reference/wire.md", "generated: wire", "generated: wires",
                                 "exception: 'wires'"),
}  # fmt: skip


@pytest.mark.slow
def test_a_defect_ends_the_build(tmp_path: Path) -> None:
    """All but the last at once; each has its line."""
    copy = tmp_path / "docs"
    shutil.copytree(ROOT / "docs", copy, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("README.md", "host", "trainer", "tests", "codegen", "runtime_c"):
        (tmp_path / name).symlink_to(ROOT / name)
    *first, last = DEFECTS.values()
    for planted in (first, [last]):
        for file, text, other, _ in planted:
            page = copy / file
            assert text in page.read_text(), file
            page.write_text(page.read_text().replace(text, other, 1))
        done = site(copy, tmp_path, "-b", "dummy")  # reads and resolves all, writes nothing
        assert done.returncode != 0
        for *_, line in planted:
            assert line in done.stderr, f"{line} not in\n{done.stderr}"


@pytest.mark.parametrize(
    "page", [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))], ids=lambda page: page.stem
)
def test_every_file_that_a_page_names_exists(page: Path) -> None:
    """Of the README too, which the site does not hold."""
    for found in LINK.finditer(page.read_text()):
        target = found[1] or found[2]
        assert (page.parent / target).exists(), f"{page.name}: {target}"
