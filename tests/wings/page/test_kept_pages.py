"""The pages in docs/ are those that this tree makes: their frame, the C, the stability words."""

import base64
import json
import re
import zlib

import pytest
from bench.press_pages import ABOUT, PAGES, page_model, page_scene
from support.paths import ROOT

from springpot.codegen.emit.files import emit_files
from springpot.codegen.plan.force_facts import force_facts
from springpot.codegen.plan.make_plan import make_plan
from springpot.host.wings.page.hands import hands_entry
from springpot.host.wings.page.page_module import port_hash
from springpot.host.wings.page.press_page import press_page
from springpot.host.wings.page.scene_entry import map_entry

AGAIN = "write it again: python tests/bench/press_pages.py"
CASES = [(page, name) for page, names in PAGES.items() for name in names]


def entries(page: str) -> list[dict]:
    text = (ROOT / "docs" / page).read_text()
    found = re.search(r'id="scenes">(.*?)</script>', text, re.DOTALL)
    assert found
    return list(json.loads(found[1]))


@pytest.mark.parametrize("page", PAGES)
def test_its_frame_is_the_templates(page: str) -> None:
    found = entries(page)
    assert [entry["name"] for entry in found] == list(PAGES[page])
    assert (ROOT / "docs" / page).read_text() == press_page(found, "hand", ABOUT[page]), AGAIN
    for entry in found:
        plan = make_plan(page_model(entry["name"]), page_scene(entry["name"]))
        assert entry["port"] == port_hash(plan if plan.has_places else None), AGAIN
        assert entry.get("map") == (map_entry(plan) if plan.has_places else None), AGAIN


@pytest.mark.parametrize(("page", "name"), CASES)
def test_its_scenes_are_what_is_emitted_with_the_hands_of_the_check(page: str, name: str) -> None:
    plan = make_plan(page_model(name), page_scene(name))
    manifest = json.loads(emit_files(plan, force_facts(plan))["manifest.json"])
    entry = next(entry for entry in entries(page) if entry["name"] == name)
    assert entry["hash"] == manifest["hash"], AGAIN
    hands = json.loads(zlib.decompress(base64.b64decode(entry["hands"])))
    assert hands == json.loads(json.dumps(hands_entry(plan))), AGAIN


@pytest.mark.parametrize("page", PAGES)
def test_it_is_small_and_fetches_nothing(page: str) -> None:
    text = (ROOT / "docs" / page).read_text()
    assert len(text) < 210_000  # five objects: 20 kB of C each, a recording, the C of a tick
    assert not re.search(r"(https?:)?//[a-z]+\.[a-z]", re.sub(r'id="scenes">.*', "", text))
    assert not re.search(r'<(link|script|img)[^>]*(src|href)="(?!data:)', text)
