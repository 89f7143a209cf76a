"""The paper's tables, figures and claims on one object, with little work."""

import json
import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from unittest import mock

import pytest
from click.testing import CliRunner
from markupsafe import escape
from support import small

from springpot.codegen.errors import UsageError
from springpot.host.evidence.commands.reproduce import reproduce, rows
from springpot.host.evidence.paper import order_claims
from springpot.host.evidence.paper.claims import Claim, check_claims
from springpot.host.evidence.paper.evidence import object_names, recorded, run_reproduce
from springpot.host.evidence.paper.order_claims import check_orders
from springpot.host.evidence.paper.page import headline
from springpot.host.evidence.paper.past_positions import HandledModel
from springpot.host.evidence.paper.reproduce import (
    PAPER_KINDS,
    ObjectRecordings,
    ObjectResult,
    Work,
    begin_object,
    fit_object,
    simulated,
    validators,
)
from springpot.host.evidence.paper.row_shares import RowShare, RowShares
from springpot.host.evidence.paper.sampling import relative_change, resampled
from springpot.host.evidence.paper.unshown_claims import check_unshown
from springpot.trainer.recordings.recording_file import write_recording

FIGURES = ["05", "07", "08", "09", "10", "11", "13", "14", "19", "20", "rows"]
LITTLE = Work(kinds=(*PAPER_KINDS, "hammerstein"), trees=5, presses=4, signals=2, paced_s=0.1)
ORIGIN = "Data: simulated objects, variant a; no real silicone."


def test_keys_files_and_captions(tmp_path: Path) -> None:
    data = simulated("ecoflex-00-50", "a", LITTLE)
    out = tmp_path / "out"
    result = run_reproduce(out, [data], ORIGIN, LITTLE)
    assert json.loads((out / "reproduce.json").read_text()) == result
    assert set(result["tables"]) == {"table1", "table2", "table3"}
    files = {f"figure-{n}.{kind}" for n in FIGURES for kind in ("svg", "pdf")}
    assert set(result["figures"]) == files
    assert all((out / name).stat().st_size > 2000 for name in files)
    models = result["models"]["ecoflex-00-50"]
    assert set(models) == set(LITTLE.kinds)
    keys = {"rmse_n", "p99_abs_error_n", "ape_below_jnd", "modelling_s", "tick_ns"}
    for metadata in models.values():
        assert keys <= set(metadata)
        assert metadata["mismatches"] == 0
        assert 0.0 < metadata["rmse_n"] < 2.0
    assert all(set(claim) == {"claim", "paper", "here", "holds"} for claim in result["claims"])
    shares = [item["share"] for item in result["rows"]["shares"]]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert set(result["past_positions"]["ecoflex-00-50"]) == {"rf-history", "rf-fd"}
    page = (out / "report.html").read_text()
    assert page.count("<img ") == len(FIGURES)
    assert all(escape(claim["claim"]) in page for claim in result["claims"])
    assert "//" not in re.sub(r"base64,[^\"]*", "", page)  # nothing outside it
    for holds, verdict in ((True, "holds"), (False, "fails")):
        count = sum(claim["holds"] is holds for claim in result["claims"])
        assert page.count(f">{verdict}</span>") == count
        assert f"{count} " in " ".join(headline(result))


@cache
def little_result(folder: Path) -> ObjectResult:
    work = Work(kinds=PAPER_KINDS, trees=5, presses=6, signals=1, paced_s=0.1)
    data = simulated("dragon-skin-fx", "b", work)
    with validators() as pool:
        return begin_object(data, fit_object(data, work), folder, work, pool)()


def judged(result: ObjectResult) -> dict[str, Claim]:
    sampled = resampled(result.models["rf-fd"], result.data.validation[0])
    return {claim.claim: claim for claim in check_claims([result], sampled)}


@pytest.mark.slow
def test_a_failing_claim_is_marked_failing(tmp_path: Path) -> None:
    result = little_result(tmp_path)
    # Give each model the other's place: what held must fail, and the other way round.
    models = dict(result.models)
    swapped = {**models, "rf-fd": models["rf-fd"], "rbf-fd": models["rbf-pv"],
               "rbf-pv": models["rbf-fd"]}  # fmt: skip
    other = ObjectResult(result.data, swapped, result.handled)
    name = "rbf-fd: RMSE below rbf-pv for every object"
    assert {judged(result)[name].holds, judged(other)[name].holds} == {True, False}
    tied = ObjectResult(result.data, {**models, "rf-fd": models["rbf-fd"]}, result.handled)
    rates = "update rates: rf-fd below rbf-fd below rbf-pv"
    assert judged(tied)[rates].holds is None
    ten_times = next(c for text, c in judged(result).items() if "ten times cheaper" in text)
    assert ten_times.holds is False
    assert "least-squares RBF is cheap" in ten_times.here
    errors = {kind: {"rmse_n": result.rmse_n(kind)} for kind in PAPER_KINDS}
    printed = rows({"data": ORIGIN, "models": {"fx": errors}, "figures": [],
                    "claims": [ten_times.as_dict()]}, tmp_path)  # fmt: skip
    assert any(key.startswith("FAILS: modelling") for key in printed)
    assert "0 of the paper's 1 claims hold here, 1 fail." in printed["in short"]
    chosen = result.models["rbf-fd"].fit.model.orders
    for offset, holds in ((0.05, True), (0.1, False)):
        told = {"dragon-skin-fx": (chosen[0] + offset, chosen[1])}
        with mock.patch.object(order_claims, "PAPER_PAIRS", told):
            (pair,) = [c for c in check_orders([result]) if "two orders" in c.claim]
        assert pair.holds is holds


def unshown(error_ratio: float, control: HandledModel, derivatives: HandledModel) -> list[Claim]:
    """The claims about rows and past positions on figures made up."""
    data = ObjectRecordings("mine", small.training(), ())
    errors, seconds = dict.fromkeys(PAPER_KINDS, 0.1), dict.fromkeys(PAPER_KINDS, 1.0)
    fifth = RowShare(0.2, 20, {**errors, "rf-fd": 0.1 * error_ratio}, seconds)
    shares = RowShares("mine", (fifth, RowShare(1.0, 100, errors, seconds)))
    handled = {"rf-history": control, "rf-fd": derivatives}
    return check_unshown([ObjectResult(data, {}, handled)], shares)


def test_rows_and_past_positions_are_judged_both_ways() -> None:
    passive = HandledModel(0, 30, 0.01, -0.02, 1e-4, 0)
    active = HandledModel(12, 30, -0.4, 0.03, 1e-4, 0)
    shaking = replace(active, unsteady=3, hold_mps=2e-2)
    assert [claim.holds for claim in unshown(1.05, shaking, passive)] == [True, True, True]
    quiet = unshown(1.2, active, passive)
    assert [claim.holds for claim in quiet] == [False, True, False]
    assert "rf-fd 1.20 x its error" in quiet[0].here
    assert [claim.holds for claim in unshown(1.0, shaking, shaking)] == [True, False, False]


def test_sampling_times() -> None:
    assert relative_change(0.0, 1.2e-3, own_taps=False) < 1e-3
    assert 0.05 < relative_change(0.5, 1.2e-3, own_taps=False) < 0.1
    assert relative_change(1.0, 1.2e-3, own_taps=True) < 0.01
    assert relative_change(1.0, 1.2e-3, own_taps=False) == pytest.approx(0.2, abs=0.02)


def test_own_recordings_are_read(tmp_path: Path) -> None:
    data = simulated("ecoflex-00-30", "a", Work(presses=20, signals=1))
    for folder, found in (("mine", data.training), ("others", data.validation)):
        (tmp_path / folder).mkdir()
        for recording in found:
            write_recording(tmp_path / folder / f"{recording.name}.h5", recording)
    read = recorded(tmp_path / "mine", tmp_path / "others")
    assert read.name == "mine"
    assert len(read.training) == len(data.training)
    assert not read.commands_n


def test_wrong_use_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no object 'jelly'"):
        object_names("ecoflex-00-30,jelly")
    assert object_names(" ecoflex-00-30,ecoflex-00-30") == ["ecoflex-00-30"]
    (tmp_path / "mine").write_text("x")
    with pytest.raises(UsageError, match="give --out a new folder"):
        run_reproduce(tmp_path, [], ORIGIN, LITTLE)
    both = ["--out", str(tmp_path / "x"), "--objects", "ecoflex-00-30", "--recordings", "a", "b"]
    assert "give one of them" in str(CliRunner().invoke(reproduce, both).exception)
