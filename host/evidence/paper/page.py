"""The page of `springpot reproduce`: a headline, the claims, the tables and figures."""

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.atomic_write import write_file
from springpot.host.pages.page import page_text, plain

PAPER_PAGE = "report.html"
_VERDICTS = {False: "fails", None: "open", True: "holds"}  # in the order of the page


def write_paper_page(out: Path, result: Mapping[str, Any]) -> Path:
    """Write out/report.html: one file, with the figures that lie in `out`."""
    pictures = [name for name in result["figures"] if name.endswith(".svg")]
    context = {
        "result": result,
        "headline": headline(result),
        "claims": [
            {**claim, "verdict": verdict}
            for holds, verdict in _VERDICTS.items()
            for claim in result["claims"]
            if claim["holds"] is holds
        ],
        "kinds": list(next(iter(result["models"].values()))),
        "pictures": {name: _base64(out / name) for name in pictures},
    }
    package = "springpot.host.evidence"
    write_file(out / PAPER_PAGE, page_text("paper.html", context, package, khz=_khz).encode())
    return out / PAPER_PAGE


def headline(result: Mapping[str, Any]) -> list[str]:
    """Answer what a reader asks first: do derivatives help, and how much of the paper holds."""
    models, claims = result["models"], [claim["holds"] for claim in result["claims"]]
    ratios = [each["rf-fd"]["rmse_n"] / each["rbf-pv"]["rmse_n"] for each in models.values()]
    mean = float(np.exp(np.mean(np.log(ratios))))
    objects = f"{len(models)} objects" if len(models) > 1 else next(iter(models))
    open_too = f", {claims.count(None)} not decided by these data" if None in claims else ""
    return [
        f"A forest on fractional derivatives (rf-fd) has {plain(mean, 2)} times the error of "
        f"radial basis functions on position and velocity (rbf-pv), {objects}.",
        f"{claims.count(True)} of the paper's {len(claims)} claims hold here, "
        f"{claims.count(False)} fail{open_too}.",
    ]


def _base64(file: Path) -> str:
    return base64.b64encode(file.read_bytes()).decode()


def _khz(rate_hz: float | None) -> str:
    return "–" if rate_hz is None else plain(rate_hz / 1e3)
