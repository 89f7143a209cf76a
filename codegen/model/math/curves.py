"""Curves of the passive model along the depth: a basis of functions, and the same as polynomials.

A curve is polynomials on equal pieces of the trained depth (sp_curve.h); its last piece goes on.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.model.model import BASIS_SIZE, Basis

Place = tuple[NDArray[np.intp], Reals]  # piece of a curve and way from its start, both (n,)


def basis(kind: Basis, u: Reals) -> Iterator[Reals]:
    """The functions of a basis one after another, each (n,); `curve_terms` has them by pieces."""
    real = u.dtype.type
    if kind == "powers":
        v = np.maximum(u, real(0))
        yield v
        yield v * v
        yield v * v * v
        return
    width = real(1) / real(8)
    for j in range(8):
        risen = np.maximum(u - real(j) * width, real(0))
        yield np.minimum(risen, width) if j < 7 else risen


def curve_terms(kind: Basis, weights: Reals) -> NDArray[np.float64]:
    """Weights (curves, J) on a basis as polynomials: (pieces, degree + 1, curves)."""
    if kind == "powers":
        constant = np.zeros((1, len(weights)))
        return np.concatenate([weights.T[::-1], constant])[None]
    # In piece j ramp j rises; those before it are full, at weight / n_pieces; those after it are 0.
    n_pieces = BASIS_SIZE[kind]
    starts = np.concatenate([np.zeros((1, len(weights))), np.cumsum(weights.T, axis=0)[:-1]])
    return np.stack([weights.T, starts / n_pieces], axis=1)


def curve_place(u: Reals, n_pieces: int) -> Place:
    """sp_curve_at: the piece that u is in and the way from its start, both (n,)."""
    real = u.dtype.type
    v = np.where(u > 0, u, real(0))
    found = np.where(v * real(n_pieces) < real(n_pieces - 1), v * real(n_pieces),
                     real(n_pieces - 1))  # fmt: skip
    piece = found.astype(np.intp)
    return piece, v - piece.astype(u.dtype) / real(n_pieces)


def curve_values(terms: Reals, place: Place) -> Reals:
    """sp_curve: values (n, curves) of terms (pieces, degree + 1, curves)."""
    piece, way = place
    values: Reals = terms[piece, 0]
    for power in range(1, terms.shape[1]):
        values = values * way[:, None] + terms[piece, power]
    return values
