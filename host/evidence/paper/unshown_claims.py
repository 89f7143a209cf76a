"""What the paper states without a figure: of the share of rows, and of past positions."""

from collections.abc import Sequence

from springpot.host.evidence.paper.claims import Claim, each_object
from springpot.host.evidence.paper.past_positions import CONTROL
from springpot.host.evidence.paper.reproduce import ObjectResult, by_softness
from springpot.host.evidence.paper.row_shares import RowShares

ENOUGH_RATIO = 1.1  # maximum error with 20 % of the rows, of that with all


def check_unshown(results: Sequence[ObjectResult], shares: RowShares) -> list[Claim]:
    """Return the claims of its sections II and IV-B."""
    results = by_softness(results)
    return [_enough_rows(shares), _negative_damping(results), _unstable(results)]


def _enough_rows(shares: RowShares) -> Claim:
    fifth, whole = shares.paper, shares.shares[-1]
    ratios = {kind: fifth.rmse_n[kind] / whole.rmse_n[kind] for kind in fifth.rmse_n}
    here = ", ".join(
        f"{kind} {ratio:.2f} x its error, {fifth.modelling_s[kind]:.2g} s against "
        f"{whole.modelling_s[kind]:.2g} s"
        for kind, ratio in ratios.items()
    )
    return Claim(
        f"20 % of the rows are enough: RMSE at most {ENOUGH_RATIO:g} x that with all rows, in "
        "all three models",
        '"after repeated tests"; more rows made RBF infeasible (section IV-B)',
        f"{shares.name}, {fifth.rows} rows against {whole.rows}: {here}; no model is infeasible "
        "on all rows here",
        max(ratios.values()) <= ENOUGH_RATIO,
    )


def _negative_damping(results: Sequence[ObjectResult]) -> Claim:
    control = [result.handled[CONTROL] for result in results]
    derivatives = [result.handled["rf-fd"] for result in results]
    cells = [found.active_cells for found in control]
    here = (
        f"active cells, of {control[0].cells}: rf-history {each_object(results, cells, 0)}; rf-fd "
        f"{each_object(results, [found.active_cells for found in derivatives], 0)}. Energy that "
        "3 s of taps give back, most of all hands: rf-history "
        f"{each_object(results, [1e3 * found.tap_energy_out_j for found in control], 0)} mJ; rf-fd "
        f"{each_object(results, [1e3 * found.tap_energy_out_j for found in derivatives], 0)} mJ"
    )
    return Claim(
        "a forest on past positions often acts with negative damping, one on fractional "
        "derivatives does not: active cells and energy from taps with every object, and with none",
        "observed (section II)",
        here,
        all(found.active_cells > 0 and found.tap_energy_out_j > 0.0 for found in control)
        and not any(found.active_cells or found.tap_energy_out_j > 0.0 for found in derivatives),
    )


def _unstable(results: Sequence[ObjectResult]) -> Claim:
    unsteady = {
        kind: [result.handled[kind].unsteady for result in results] for kind in (CONTROL, "rf-fd")
    }
    speeds = {
        kind: max(1e3 * result.handled[kind].hold_mps for result in results) for kind in unsteady
    }
    here = "; ".join(
        f"{kind}: holds and taps that vibrate or leave their bounds "
        f"{each_object(results, counts, 0)}, at most {speeds[kind]:.2f} mm/s on a hold"
        for kind, counts in unsteady.items()
    )
    return Claim(
        "and rendered to a hand, a forest on past positions is unstable where one on fractional "
        "derivatives is stable (three simulated hands, no coupling)",
        "not stable when rendered (section II)",
        here,
        min(unsteady[CONTROL]) > 0 and not any(unsteady["rf-fd"]),
    )
