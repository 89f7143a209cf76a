"""Pages in a headless browser: pictures, the page's own figures, what its console said."""

import html
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
NEEDS_CHROMIUM = pytest.mark.skipif(CHROMIUM is None, reason="no chromium on PATH")
A4_PIXELS = 703  # between the margins
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
         "--enable-logging=stderr")  # fmt: skip
# What sticks out of the page or of its cell, and words that a line break cuts in two.
_MEASURES = """<script>
const out = [];
for (const cell of document.querySelectorAll("td, th, p, h1, h2, h3, figure, pre")) {
  const box = cell.getBoundingClientRect();
  if (box.right > document.documentElement.clientWidth + 1) out.push(cell.textContent.slice(0, 60));
}
const cut = [];
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
const range = document.createRange();
while (walker.nextNode()) {
  const text = walker.currentNode;
  if (text.parentElement.closest("svg, script, style, pre, .provenance")) continue;
  for (const word of text.data.matchAll(/[\\p{L}\\p{N}.]{2,}/gu)) {
    range.setStart(text, word.index);
    range.setEnd(text, word.index + word[0].length);
    if (new Set([...range.getClientRects()].map((box) => Math.round(box.top))).size > 1)
      cut.push(word[0]);
  }
}
document.body.dataset.measures = JSON.stringify({out, cut});
</script></body>"""


def browse(page: Path, width: int, *how: str) -> subprocess.CompletedProcess[str]:
    """Open a page in a window of so many pixels."""
    command = [CHROMIUM, *FLAGS, f"--user-data-dir={page.parent / 'profile'}",
               f"--window-size={width},6000", *how, page.as_uri()]  # fmt: skip
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)


def console_errors(done: subprocess.CompletedProcess[str]) -> list[str]:
    return [line for line in done.stderr.splitlines() if "CONSOLE" in line]


def layout_faults(page: str, folder: Path, width: int) -> dict[str, list[str]]:
    """What sticks out of a page of that width (`out`), and words cut in two (`cut`)."""
    copy = folder / f"page-{width}.html"
    copy.write_text(page.replace("</body>", _MEASURES))
    done = browse(copy, width, "--dump-dom")
    found = re.search(r'data-measures="([^"]*)"', done.stdout)
    assert found, done.stderr
    return json.loads(html.unescape(found[1]))


def as_printed(page: str) -> str:
    """The page with its rules for paper."""
    return page.replace("@media print", "@media all")
