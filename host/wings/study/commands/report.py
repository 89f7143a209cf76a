"""`springpot study report`: what a study found."""

from pathlib import Path

import click

from springpot.console import json_option, print_result


@click.command("report")
@click.argument("study", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Folder; by default STUDY/report.")
@click.option("--bids", type=click.Path(path_type=Path), help="A new folder for a BIDS data set.")
@json_option
def report_(study: Path, out: Path | None, bids: Path | None, as_json: bool) -> None:
    """Open the key of STUDY; write a page and tables of its results.

    It can be asked for at any time: what the answers do not suffice for yet is named. Whoever reads
    it knows what was behind every code.
    """
    from springpot.host.wings.study.report.page import write_study_report

    result = write_study_report(study, out, bids)
    rows = {
        "report": result["out"],
        "tables": ", ".join(result["tables"]),
        "people": f"{result['people']}, {len(result['excluded'])} of them left out",
        "trials": str(result["trials"]),
    }
    if bids is not None:
        rows["BIDS"] = str(bids)
    print_result(result, as_json, rows)
