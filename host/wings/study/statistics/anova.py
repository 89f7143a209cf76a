"""Repeated-measures analysis of variance with one or two factors, by orthonormal contrasts.

An effect of d degrees of freedom is a matrix C of d orthonormal contrasts between the conditions.
Of the scores Z = Y C that it makes of each person's row, the mean is the effect and the scatter
around the mean is its error. That is also where sphericity is seen: it holds when the covariance of
Z is a multiple of the identity; the corrections of Greenhouse and Geisser and of Huynh and Feldt
shrink the degrees of freedom by how far it is from that.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import linalg, stats

from springpot import DataError, UsageError
from springpot.basics import Samples

_MIN_PEOPLE = 3
_ROUNDING = 1e-12  # of the scores' squares: below that, a sum of squares is zero


@dataclass(frozen=True)
class Effect:
    """One line of the table.

    p is uncorrected; p_gg and p_hf have both degrees of freedom multiplied by eps_gg and eps_hf;
    eta_g is the generalised eta squared where every factor is manipulated (Olejnik, Algina 2003).
    """

    effect: str
    df1: int
    df2: int
    f: float
    p: float
    eps_gg: float
    p_gg: float
    eps_hf: float
    p_hf: float
    eta_g: float


def repeated_measures(scores: Samples, factors: Sequence[str]) -> tuple[Effect, ...]:
    """Return main effects in the order of factors, then their interaction.

    scores: (people, levels) or (people, levels of the first factor, levels of the second)."""
    if len(factors) not in {1, 2} or scores.ndim != 1 + len(factors):
        raise UsageError(
            f"scores of {scores.ndim - 1} factors, {len(factors)} names: give one or two factors"
        )
    people, *levels = scores.shape
    require_complete(scores)
    rows = scores.reshape(people, -1)
    average = [np.full((n, 1), n**-0.5) for n in levels]  # over the levels of a factor
    between = [contrasts(n) for n in levels]
    names: list[str] = []
    matrices: list[Samples] = []
    for chosen in ((True,), (True, False), (False, True), (True, True)):
        if len(chosen) == len(levels):
            names.append(":".join(f for f, use in zip(factors, chosen, strict=True) if use))
            matrix = np.ones((1, 1))
            for over, to, use in zip(average, between, chosen, strict=True):
                matrix = np.kron(matrix, to if use else over)
            matrices.append(matrix)
    projected = [rows @ matrix for matrix in matrices]
    means = [z.mean(axis=0) for z in projected]
    errors = [float(np.sum((z - mean) ** 2)) for z, mean in zip(projected, means, strict=True)]
    of_each = rows.mean(axis=1)
    subjects = rows.shape[1] * float(np.sum((of_each - of_each.mean()) ** 2))
    noise = _ROUNDING * float(np.sum((rows - rows.mean()) ** 2)) + np.finfo(float).tiny
    effects = []
    for name, z, mean, error in zip(names, projected, means, errors, strict=True):
        if error <= noise:
            raise DataError(
                f"{name}: everybody's scores differ alike between its levels, so that there is no "
                "error to test against: were the answers entered by a person?"
            )
        effects.append(_effect(name, z, mean, error, subjects + sum(errors)))
    return tuple(effects)


def require_complete(scores: Samples) -> None:
    """Raise DataError unless every person has a score in every of at least two conditions."""
    people = len(scores)
    if people < _MIN_PEOPLE:
        raise DataError(f"{people} people: an analysis of variance needs at least {_MIN_PEOPLE}")
    if min(scores.shape[1:]) < 2:
        raise DataError("a factor with one level: there is nothing to compare")
    missing = np.argwhere(~np.isfinite(scores))
    if len(missing):
        person, *cell = (int(i) + 1 for i in missing[0])
        raise DataError(
            f"{len(missing)} scores are missing, the first of person {person} in condition "
            f"{' x '.join(map(str, cell))}: run these trials, or leave the person out"
        )


def contrasts(levels: int) -> Samples:
    """Return orthonormal contrasts between levels: (levels, levels - 1)."""
    return np.ascontiguousarray(linalg.helmert(levels).T)


def sphericity(z: Samples) -> tuple[float, float]:
    """Return epsilons of Greenhouse-Geisser and Huynh-Feldt of scores on contrasts (people, d)."""
    people, d = z.shape
    if d == 1:
        return 1.0, 1.0
    covariance = np.cov(z, rowvar=False)
    greenhouse = float(np.trace(covariance) ** 2 / (d * np.sum(covariance**2)))
    shared = d * greenhouse
    freedom = people - 1.0 - shared
    huynh = (people * shared - 2.0) / (d * freedom) if freedom > 1e-9 else 1.0
    return greenhouse, min(1.0, huynh)


def _effect(name: str, z: Samples, mean: Samples, error: float, all_error: float) -> Effect:
    people, df1 = z.shape
    df2 = df1 * (people - 1)
    size = people * float(mean @ mean)
    f = (size / df1) / (error / df2)
    eps_gg, eps_hf = sphericity(z)

    def p(epsilon: float) -> float:
        return float(stats.f.sf(f, epsilon * df1, epsilon * df2))

    eta_g = size / (size + all_error)
    return Effect(name, df1, df2, f, p(1.0), eps_gg, p(eps_gg), eps_hf, p(eps_hf), eta_g)
