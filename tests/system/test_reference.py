"""The generated pages of the reference: complete, and as the code is."""

import json
import re
import sys
import typing
from dataclasses import fields, is_dataclass, replace
from pathlib import Path

import click
from support.paths import ROOT
from support.small import small_model

import springpot
from springpot.codegen import scene
from springpot.codegen.emit.files import emit_files
from springpot.codegen.plan.force_facts import force_facts
from springpot.codegen.plan.make_plan import make_plan
from springpot.host.cli import springpot as command_line
from springpot.host.emission.scene_file import scene_to_json
from springpot.host.wings.study import definition
from springpot.host.wings.study.definition import Study

sys.path.append(str(ROOT / "docs" / "_ext"))
from reference_pages import commands, scene_keys
from reference_pages.c_header import c_functions, declarations, notes
from reference_pages.python_names import python_name_list
from reference_pages.wire import wire_messages

PLAIN = scene.Scene(schema=1, name="x", model="x.spm")


def test_every_key_of_a_scene_is_listed() -> None:

    keys = json.loads(scene_to_json(PLAIN))
    sections = {name: section for name, section in keys.items() if isinstance(section, dict)}
    expected = {f"{name}.{key}" for name, section in sections.items() for key in section}
    expected |= {f".{name}" for name in keys if name not in sections}
    rows = list(scene_keys.key_rows())
    assert {f"{row.section}.{row.name}" for row in rows} == expected
    assert len(rows) > 40
    table = scene_keys.scene_key_tables()
    for row in rows:
        assert f"[`{row.name}`]{{#" in table
        assert row.meaning.endswith(".")


def test_a_row_says_unit_default_and_bounds() -> None:
    rows = {f"{row.section}.{row.name}": row[2:] for row in scene_keys.key_rows()}
    assert rows["runtime.rate_hz"][0::2][:2] == ("Hz", "10 to 8000")
    assert rows["runtime.rate_hz"][1].startswith("the model's own")
    assert rows["coupling.damping_nspm"][:3] == ("N s/m", "`20.0`", "1e-06 to 1e+07")
    assert rows["guard.max_force_n"][2] == "above 0, to 10000"
    assert rows["guard.contact"][2] == '`"surface"`, `"always"`'
    assert rows["budget.flash_bytes"][:3] == ("bytes", "none", "above 0")
    assert rows["device.surface_mm"][2] == "any"
    assert rows["runtime.measured_step"][2] == "`true`, `false`"
    assert rows[".schema"][1] == "must be stated"


def test_every_command_and_option_is_listed() -> None:
    page = commands.command_pages()
    context = click.Context(command_line, info_name="springpot")
    listed = dict(commands.every_command(context))
    assert len(listed) > 14
    assert "springpot study plan" in listed
    for name, command in listed.items():
        section = page.split(f"\n## {name}\n")[1].split("\n## ")[0]
        for option in command.params:
            if isinstance(option, click.Option):
                assert f":::{{option}} {option.opts[0]}" in section, name
    assert "Default: `cv`." in page
    assert "Range: 0<x<=1." in page


def test_every_function_and_note_of_c_is_listed() -> None:
    header = (ROOT / "runtime_c" / "include" / "sp.h").read_text()
    functions = [line for group in declarations() for line in group.functions]
    for name in ("sp_init", "sp_reset", "sp_step", "sp_step_dt", "sp_run", "sp_idle", "sp_place",
                 "sp_step3", "sp_idle3", "sp_selftest", "sp_manifest", "sp_state_size",
                 "sp_abi_version"):  # fmt: skip
        assert f"{name}(" in header
        assert len([line for line in functions if f"{name}(" in line]) == 1
        assert f"{name}(" in c_functions()
    assert len(functions) == len(
        re.findall(r"^(?:int|void|uint32_t|const char) [^;]*\(", header, re.M)
    )
    assert all(group.comment for group in declarations())
    assert ("SP_NOTE_LATCHED", 32) in {note[:2] for note in notes()}
    assert ("SP_ERROR_TIME_STEP", -2) in {note[:2] for note in notes()}
    assert len(notes()) == (ROOT / "runtime_c" / "include" / "sp_notes.h").read_text().count(" = ")


def test_the_page_of_c_lists_them_without_the_site_too() -> None:
    page = (ROOT / "docs" / "reference" / "c.md").read_text()
    for group in declarations():
        for function in group.functions:
            name, given = re.findall(r"(\w+)\((.*)\)", function)[0]
            names = re.findall(r"(\w+)(?:\[3\])?(?:,|$)", given)
            assert f"`{name}({', '.join(n for n in names if n != 'void')})`" in page.replace(
                "&", ""
            )
    for name, value, _ in notes():
        assert f"| {value} | `{name}` |" in page


def test_every_message_and_field_of_the_wire_is_listed() -> None:
    page = wire_messages()
    assert "## HELLO, type 2" in page
    assert "| `max_n` | `f32` | maximum force of its motor |" in page
    text = (ROOT / "runtime_c" / "port" / "wire" / "sp_wire_messages.h").read_text()
    table = text[text.index("#define SP_WIRE_ASK") :]
    assert page.count("| `f32` |") == table.count("FIELD(f32")
    assert page.count("| `SP_WIRE_") == table.count(" = ")


def test_every_public_name_of_python_is_listed() -> None:
    page = python_name_list()
    for name in springpot.__all__:
        assert f":: {name}\n" in page
        assert typing.cast("str | None", getattr(springpot, name).__doc__)


def test_every_key_of_a_study_is_listed() -> None:
    page = (ROOT / "docs" / "reference" / "study.md").read_text()
    table = page.split("## Keys of a study file")[1].split("\n## ")[0]
    own = (kind for kind in vars(definition).values() if kind.__class__ is type)
    kinds = [kind for kind in own if is_dataclass(kind) and kind.__module__ == definition.__name__]
    assert Study in kinds
    keys = {key.name for kind in kinds for key in fields(kind)}
    assert len(keys) > 30
    for key in keys:
        assert f"`{key}`" in table or f"[{key}]" in table, key


def test_every_key_of_a_manifest_is_listed(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "reference" / "files.md").read_text().split("## manifest.json")[1]
    runtime = scene.Runtime(target="cortex-m4f")
    for stated in (PLAIN, replace(PLAIN, runtime=runtime)):
        plan = make_plan(small_model(), stated)
        manifest = json.loads(emit_files(plan, force_facts(plan))["manifest.json"])
        assert {key for key in manifest if f"`{key}`" not in page} == set()
