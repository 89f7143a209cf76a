"""The paper's figures, tables and claims, one by one, beside what springpot finds on them.

    python examples/reproduce.py --out paper --objects ecoflex-00-30 dragon-skin-10

The paper: doi 10.1109/ACCESS.2022.3230065. Writes OUT/claims.json, a list, and OUT/page.html.
Needs springpot[train,report]; 1.5 minutes of a core an object.
"""

import argparse
import json
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from paper_claims import Claim, claims
from paper_formulas import Samples, press as command, rms
from paper_page import headline, page
from paper_results import COUPLED, KINDS, LETTER, OBJECTS, ORDERS, OWN, PAST, SLOW_S, Hands, Result

import springpot
from springpot import predict, record


def measured(name: str, folder: Path, every: int = 1, n: int = 10, trees: int = 100) -> Result:
    """Record the paper's protocols on one object, fit, emit and validate.

    Less work for a test: one press in `every`, n signals, forests of so many trees.
    """
    url = f"sim://{name}?variant=a"
    presses = record(url, "paper", folder / "presses", seed=1)
    signals = [averaged(one) for one in record(url, "validation", folder / "s", seed=2)[:n]]
    train = partial(springpot.train, presses[::every], trees=trees, smooth_s=0.025)
    scene = springpot.Scene(1, "paper", "model.spm")
    scene, coupled = (replace(scene, coupling=replace(scene.coupling, mode=mode),
                              smoothing=replace(scene.smoothing, time_constant_s=average_s))
                      for mode, average_s in (("off", 0.0), ("tool", 0.83e-3)))  # fmt: skip

    fits = {kind: train(kind, validation=signals if kind == "rbf-fd" else (), **LETTER[kind])
            for kind in KINDS}  # fmt: skip
    pairs = fits["rbf-fd"].metadata["pairs"]

    def checked(place: str, fit: springpot.Fit) -> dict[str, Any]:
        springpot.emit(folder / place, model=fit, scene=scene, accept_unsafe=True)
        found = [springpot.validate(folder / place, signals[:1], paced_s=0.2).as_dict()
                 for _ in range(2)]  # fmt: skip
        return min(found, key=lambda one: float(one["tick_ns"]["hot_median"]))

    validated = {kind: checked(kind, fit) for kind, fit in fits.items()}
    loaded = {kind: springpot.load(folder / kind) for kind in KINDS}
    predicted_n = {kind: [one.run(signal)[0].astype(np.float64) for signal in signals]
                   for kind, one in loaded.items()}  # fmt: skip
    importance = np.asarray(fits["rf-fd"].metadata["importance"])

    forest = partial(train, "rf-fd", **LETTER["rf-fd"])
    as_chosen = {"rbf-fd": {"orders": pairs["paper"]}}  # without the search
    more = {
        **{f"{kind}, all rows": train(kind, fraction=1.0, **as_chosen.get(kind, LETTER[kind]))
           for kind in KINDS},
        "rbf-fd, by cross-validation": train("rbf-fd", orders=pairs["cv"]),
        "important orders": forest(orders=np.array(ORDERS)[importance > 0.1].tolist()),
        "orders to 1": forest(orders=(*ORDERS, *(0.5 + order for order in ORDERS))),
        PAST: forest(past_positions=True),
        OWN: train("rf-fd"),
    }  # fmt: skip
    again = {kind: train(kind, **as_chosen.get(kind, LETTER[kind])) for kind in KINDS}
    times_s = {kind: min(each[kind].feature_s + each[kind].fit_s for each in (fits, again))
               for kind in KINDS}  # fmt: skip
    small = {"rf-fd": forest(trees=10), "rbf-pv": train("rbf-pv", n_centers=10, **LETTER["rbf-pv"])}
    small_ns = {kind: checked("small", fit)["tick_ns"]["hot_median"] for kind, fit in small.items()}
    length = len(signals[0].force_n)
    trained, tested = (  # depth, m, and speed, m/s
        np.hstack([(one.position_m, np.abs(np.gradient(one.position_m, one.dt_s))) for one in each])
        for each in ([averaged(one) for one in presses], signals)
    )
    press = next(one for one in presses if one.name.endswith("-10n-1hz"))
    median = int(np.argsort(errors_n(signals, predicted_n["rf-fd"]))[len(signals) // 2])
    forces_n = {kind: [predict(fit, one) for one in signals] for kind, fit in more.items()}
    own = springpot.emit(folder / "own", model=more[OWN], scene=scene, accept_unsafe=True)
    return Result(
        name=name,
        total_s=sum(len(press.force_n) * press.dt_s for press in presses),
        depth_m=max(float(press.position_m.max()) for press in presses),
        beyond=float(np.mean(np.any(trained.max(axis=1) < tested.T, axis=1))),
        press=(5.0 * command(), press.force_n, press.position_m),
        pairs=pairs,
        importance=importance,
        modelling_s={kind: fit.feature_s + fit.fit_s for kind, fit in more.items()} | times_s,
        validated=validated,
        rmse_n={kind: errors_n(signals, found_n).mean() for kind, found_n in
                {**forces_n, **predicted_n}.items()},
        nodes={"rf-fd": fits["rf-fd"].metadata["n_nodes"], OWN: more[OWN].metadata["n_nodes"]},
        hands={PAST: in_hands(more[PAST], scene), "rf-fd": in_hands(fits["rf-fd"], scene),
               COUPLED: in_hands(fits["rf-fd"], coupled)},
        own_active_cells=own.check.as_dict()["active_cells"],
        small_ns=small_ns,
        slow=slow_ticks(loaded["rf-fd"], signals[0].position_m),
        measured_n=np.concatenate([signal.force_n for signal in signals]),
        position_m=np.concatenate([signal.position_m for signal in signals]),
        predicted_n={kind: np.concatenate(forces) for kind, forces in predicted_n.items()},
        shown=slice(length * median, length * (median + 1)),
    )  # fmt: skip


def averaged(recording: springpot.Recording) -> springpot.Recording:
    """Position and force by a zero-phase moving average over 25 samples (III-C)."""
    position_m, force_n = (np.convolve(np.pad(channel, 12, "edge"), np.full(25, 1 / 25), "valid")
                           for channel in (recording.position_m, recording.force_n))  # fmt: skip
    return replace(recording, position_m=position_m, force_n=force_n)


def in_hands(fit: springpot.Fit, scene: springpot.Scene) -> Hands:
    """The stability check of a model in a scene."""
    keys = springpot.stability(model=fit, scene=scene).as_dict()
    by_name = {name: [case for case in keys["closed_loop"] if case["case"] == name]
               for name in ("hold", "tap-4hz", "tap-8hz", "deep", "fast")}  # fmt: skip
    taps = by_name["tap-4hz"] + by_name["tap-8hz"]
    lost = [case["grows"] or not case["bounded"] for case in taps + by_name["hold"]]
    loud = [max(case["hf_speed_mps"], case["lf_speed_mps"] or 0.0) > 1e-3
            for case in by_name["hold"]]  # fmt: skip
    beyond = [case["grows"] or not case["bounded"] for case in by_name["deep"] + by_name["fast"]]
    return Hands(
        active_cells=keys["scene_map"]["active_cells"],
        taps_mj=max(1e3 * case["energy_out_j"] for case in taps if not case["delay_samples"]),
        unsteady=sum(map(max, lost, [False] * len(taps) + loud)),
        unbounded=sum(beyond),
        cases=(len(lost), len(beyond)),
        stiffness_npm=keys["limit"]["object_stiffness_npm"],
    )


def errors_n(signals: Sequence[springpot.Recording], forces_n: Sequence[Samples]) -> Samples:
    """RMSE of forces on each signal, (signals,), N."""
    return np.array([rms(each - one.force_n) for one, each in zip(signals, forces_n, strict=True)])


def slow_ticks(loaded: Any, position_m: Samples) -> tuple[Samples, Samples, Samples]:
    """Time, force of loaded C in ticks of SLOW_S, and of that motion resampled to 1 ms."""
    time_s = loaded.dt_s * np.arange(len(position_m))
    slow_s = np.arange(0.0, time_s[-1], SLOW_S)
    slow_m = np.interp(slow_s, time_s, position_m)
    slow_n, _ = loaded.run(slow_m)
    force_n, _ = loaded.run(np.interp(time_s, slow_s, slow_m))
    return time_s, np.interp(time_s, slow_s, slow_n), force_n


def reproduce(out: Path, objects: Sequence[str], **work: int) -> list[Claim]:
    """Write out/claims.json and out/page.html of these objects; work: of `measured`."""
    names = sorted(set(objects), key=OBJECTS.index)
    with tempfile.TemporaryDirectory() as folder, ProcessPoolExecutor() as pool:
        jobs = [pool.submit(measured, name, Path(folder, name), **work) for name in names]
        results = [job.result() for job in jobs]
    found = list(claims(results))
    out.mkdir(parents=True, exist_ok=True)
    (out / "claims.json").write_text(json.dumps([asdict(claim) for claim in found], indent=2))
    (out / "page.html").write_text(page(found, results), encoding="utf-8")
    return found


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--objects", nargs="+", choices=OBJECTS, default=OBJECTS)
    given = parser.parse_args()
    try:
        print(headline(reproduce(given.out, given.objects)))
    except springpot.SpringpotError as error:
        sys.exit(f"reproduce: {error}")
