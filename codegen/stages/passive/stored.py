"""Stored energy of curves that never fall: sp_stored.h, and the areas that it reads."""

from typing import Any

import numpy as np

from springpot.codegen.arrays import Reals, Samples
from springpot.codegen.model.formulas import Place, curve_place, curve_values
from springpot.codegen.stages.passive.hammerstein import HammersteinStage
from springpot.codegen.stages.stage import LARGEST, SMALLEST

RENEWED = 0.25  # SP_STORED_RENEWED


def stored_areas(stage: HammersteinStage) -> Samples:
    """Integrals up to each node of spring, branches and stops, one after the other, N pieces."""
    parts = [_areas(stage.spring[:, :, None]), _areas(stage.branches)]
    parts += [_areas(stop[:, :, None]) for stop in stage.stops]
    return np.concatenate([part.ravel() for part in parts])


def _areas(nodes: Reals) -> Samples:
    """Integrate curves (J + 1, 2, curves) up to their first J nodes, (J, curves)."""
    value, slope = nodes[:-1, 0].astype(np.float64), nodes[:, 1].astype(np.float64)
    pieces = value + slope[:-1] / 2.0 + (slope[1:] - slope[:-1]) / 6.0
    areas: Samples = np.concatenate([np.zeros((1, nodes.shape[2])), np.cumsum(pieces, axis=0)])
    return areas[:-1]


def stored(
    stage: HammersteinStage, areas: Reals, place: Place, held: Reals, play: Reals
) -> tuple[Any, Any]:
    """sp_stored: what one material has stored, and at most how much more a share renewed, N pieces.

    place: of the model, each (1,). held: of each branch, (branches,); play: of each stop, (stops,).
    """
    config, real = stage.config, stage.spring.dtype.type
    pieces, branches = config.n_pieces, config.n_branches
    spring, of_branches, *of_stops = np.split(
        areas, [pieces, *(pieces * (1 + branches + k) for k in range(config.n_stops))]
    )
    total = _area(spring[:, None], stage.spring[:, :, None], place)[0]
    g = curve_values(stage.branches, place)[0]
    z = g - held
    its = of_branches.reshape(pieces, branches)
    lost = _lost(its, stage.branches, place, z)
    of_each = _area(its, stage.branches, place) - lost
    more = lost - _lost(its, stage.branches, place, (real(1) - real(RENEWED)) * z)
    takes = real(0)
    for i in np.flatnonzero((g > 0) | (z > 0)).tolist():
        total, takes = total + of_each[i], takes + more[i]
    for k, its in enumerate(of_stops):
        stop = stage.stops[k][:, :, None]
        at = curve_place(play[k : k + 1], pieces)
        its_z = curve_values(stop, at)[0]
        total = total - (_area(its[:, None], stop, at) + its_z * _way(at, place))[0]
    return total, takes / real(RENEWED)


def _area(areas: Reals, nodes: Reals, place: Place) -> Reals:
    """sp_stored_area of each curve, (curves,); place: of all, each (1,), or of each, (curves,)."""
    piece, way = place
    real, each = nodes.dtype.type, np.arange(nodes.shape[2])
    slope = nodes[piece, 1, each]
    bend = nodes[piece + 1, 1, each] - slope
    third = way * real(1.0 / 3.0)
    mean = nodes[piece, 0, each] + real(0.5) * way * (slope + third * bend)
    area: Reals = areas[piece, each] + way * mean
    return area


def _lost(areas: Reals, nodes: Reals, u: Place, z: Reals) -> Reals:
    """sp_stored_lost of each curve, (curves,)."""
    y = _where(nodes, z)
    lost: Reals = _area(areas, nodes, y) + z * _way(y, u)
    return lost


def _where(nodes: Reals, z: Reals) -> Place:
    """sp_stored_where of each curve, (curves,)."""
    real, each = nodes.dtype.type, np.arange(nodes.shape[2])
    piece = np.sum(~(nodes[1:-1, 0] > z), axis=0)
    slope = nodes[piece, 1, each]
    twice = real(2) * (z - nodes[piece, 0, each])
    square = slope * slope + (nodes[piece + 1, 1, each] - slope) * twice
    total = slope + np.sqrt(np.where(square > 0, square, real(0)))
    known = (twice > 0) & (total > real(SMALLEST))
    way = np.where(known, twice / np.where(known, total, real(1)), real(0))
    return piece, np.minimum(way, real(LARGEST))


def _way(begin: Place, end: Place) -> Reals:
    """sp_stored_way."""
    real = end[1].dtype
    way: Reals = (end[0].astype(real) - begin[0].astype(real)) + (end[1] - begin[1])
    return way
