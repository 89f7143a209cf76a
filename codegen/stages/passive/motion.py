"""Reference of the passive model along a motion: the operations of the C, in its order."""

from copy import copy
from itertools import chain
from typing import TYPE_CHECKING, Self

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.model.formulas import (
    SMALLEST,
    count_intervals,
    evaluate_curves,
    evaluate_flow_functions,
    locate_on_curve,
    play_operator,
    scalar_type,
    to_scalars,
)
from springpot.codegen.model.passive import Hammerstein, Memory, sort_by_power
from springpot.codegen.stages.passive.maxwell import MaxwellBranches
from springpot.codegen.stages.stage import VECTOR_WIDTH
from springpot.codegen.types import RealType, Scalar

if TYPE_CHECKING:
    from springpot.codegen.stages.passive.hammerstein import HammersteinStage

_CHUNK, _MIN_CHUNK = 512, 16  # ticks that are taken at once as long as the tool does not leave
_Piece = list[tuple[Scalar, ...]]  # of each curve: value, slope, and rise of the slope


class PassiveMotion:
    """State of one passive model, with the tool at u, from its stage's start on.

    Ticks in which the tool stays on the object are computed together. Where it would pull, the
    ticks before are computed again, and then one tick after another until the tool is back.
    """

    def __init__(self, stage: "HammersteinStage", u: Scalar) -> None:
        """Begin at rest at u, or as training ended if u is near where that was."""
        config, real, start = stage.config, stage.spring.dtype.type, stage.start
        start_u = start.position(u) if start else None
        if start_u is None:
            start = None  # too far away: at rest
        else:
            u = start_u
        self._set_stage(stage, u)
        held_n = start.held_n if start else np.zeros(config.n_branches, dtype=real)
        self._branch_state = [
            held_n[step.first : step.first + step.count].astype(np.float64 if step.double else real)
            for step in stage.steps
        ]
        self._play = start.play if start else np.full(config.n_stops, u, dtype=real)
        self._functions = evaluate_flow_functions(np.array([u]))[0]
        self._flow = start.flow if start else np.zeros(stage.flow.count if stage.flow else 0, real)
        deepest = u if u > 0 else real(0)
        self._deepest = np.full(stage.damage.count if stage.damage else 0, deepest, dtype=real)
        if start:
            self._deepest = np.maximum(self._deepest, start.deepest)
        self._u, self._force_n = u, start.force_n if start else real(0)

    @property
    def u(self) -> Scalar:
        """Normalised depth of the model."""
        return self._u

    def memory(self, model: Hammerstein) -> Memory:
        """Return the memory of the stage's model; ticks in float64, vectors of one branch."""
        flow, deepest = self._flow.copy(), self._deepest.copy()
        if model.flow is not None:
            flow[sort_by_power(model.flow)] = self._flow
        if model.damage is not None:
            deepest[sort_by_power(model.damage)] = self._deepest
        branch_n = np.concatenate(self._branch_state)[: len(model.tau_s)]
        at = float(self._u), float(self._force_n)
        return Memory(branch_n, flow, deepest, self._play.astype(np.float64), *at)

    def with_stage(self, stage: "HammersteinStage") -> Self:
        """The same state in ticks of another length: the stage of the same model."""
        other = copy(self)
        other._set_stage(stage, self._u)
        return other

    def _set_stage(self, stage: "HammersteinStage", u: Scalar) -> None:
        self._stage = stage
        self._stops = np.moveaxis(stage.stops, 0, 2)
        self._curves = np.concatenate([stage.spring[:, :, None], stage.branches], axis=2)
        location = locate_on_curve(np.array([u]), stage.config.n_intervals)
        self._before = evaluate_curves(self._curves, location)[0, 1:]

    def along(self, u: Reals) -> tuple[Reals, Reals]:
        """Return the force of ticks with the tool at u, (n,), N, and the model's u, (n,).

        A chunk is tried as if the tool stayed on the object, which is fast. If the object lets go
        within it, the state is restored, only the ticks before that are made again, and the ticks
        without contact follow one by one. `copy` is enough: no array is changed in place.
        """
        if self._stage.surface is None:
            return self._advance_in_contact(u), u
        force_n, at = np.empty_like(u), u.copy()
        done, chunk = 0, _CHUNK
        while done < len(u):
            part = u[done : done + chunk]
            before = copy(self)
            contact_n = self._advance_in_contact(part)
            n_contact = self._count_contact_ticks(before, part, contact_n)
            if n_contact < len(part):  # the object lets go: restore, and stop before
                self.__dict__.update(before.__dict__)
                contact_n = self._advance_in_contact(part[:n_contact])
            force_n[done : done + n_contact] = contact_n
            done += n_contact
            chunk = min(2 * chunk, _CHUNK)
            if n_contact < len(part):
                done = self._advance_detached(u, done, force_n, at)
                chunk = _MIN_CHUNK
        return force_n, at

    def _count_contact_ticks(self, before: "PassiveMotion", u: Reals, force_n: Reals) -> int:
        """Ticks, of those at u (n,), until the tool leaves the surface."""
        surface = self._stage.surface
        assert surface is not None
        last_u = np.concatenate([[before._u], u[:-1]])
        last_n = np.concatenate([[before._force_n], force_n[:-1]])
        for i in np.flatnonzero(surface.may_leave(u, last_u, last_n)).tolist():
            if surface.at(u[i], last_u[i], last_n[i]) > u[i]:
                return i
        return len(u)

    def _advance_detached(self, u: Reals, done: int, force_n: Reals, at: Reals) -> int:
        """Advance tick by tick while the tool is off the surface; return the first tick back on it.

        In numbers and not in arrays: of one tick those take seven times as long.
        """
        surface = self._stage.surface
        assert surface is not None
        tick, end = _DetachedTick(self._stage, self._curves, self._stops), done
        tick.begin(self._before, self._branch_state, self._play)
        chunks = (to_scalars(u[begin : begin + _CHUNK]) for begin in range(done, len(u), _CHUNK))
        for tool_u in chain.from_iterable(chunks):
            model_u = surface.at(tool_u, self._u, self._force_n)
            contact_n = tick.advance(model_u)
            if self._stage.flow is not None or self._stage.damage is not None:
                contact_n = self._add_extra_force_n(np.array([model_u], u.dtype), contact_n)[0]
            self._u, self._force_n = model_u, contact_n
            at[end], detached = model_u, model_u > tool_u
            force_n[end] = 0 if detached else contact_n
            end += 1
            if not detached:
                break
        self._before, self._branch_state, self._play = tick.end(u.dtype.type)
        return end

    def _advance_in_contact(self, u: Reals) -> Reals:
        """Force of ticks with the model at u, (n,), N."""
        stage = self._stage
        if not len(u):
            return u
        location = locate_on_curve(u, stage.config.n_intervals)
        curves = evaluate_curves(self._curves, location)
        g = curves[:, 1:]
        rises = g - np.concatenate([self._before[None], g[:-1]])
        self._before = g[-1]
        branch_n, ends = np.empty_like(g), []
        for step, begins in zip(stage.steps, self._branch_state, strict=True):
            columns = slice(step.first, step.first + step.count)
            states = step.advance(rises[:, columns], location, begins)
            branch_n[:, columns] = states
            ends.append(states[-1])
        self._branch_state = ends
        force_n = self._static_force_n(u, curves[:, 0]) + _sum_branches(branch_n)
        force_n = self._add_extra_force_n(u, force_n)
        self._u, self._force_n = u[-1], force_n[-1]
        return force_n

    def _add_extra_force_n(self, u: Reals, force_n: Reals | Scalar) -> Reals:
        """Add the forces of nonlinear dashpots and damage to contact_n, (n,), N."""
        stage = self._stage
        if stage.flow is not None:
            flow_n, self._functions, self._flow = stage.flow.advance(u, self._functions, self._flow)
            force_n = force_n + flow_n
        if stage.damage is not None:
            location = locate_on_curve(u, stage.config.n_intervals)
            damage_n, self._deepest = stage.damage.advance(u, location, self._deepest)
            force_n = force_n + damage_n
        return force_n

    def _static_force_n(self, u: Reals, spring_n: Reals) -> Reals:
        """Return the force of spring, sliders and bias at u, (n,), N; moves the sliders."""
        still_n: Reals = spring_n + self._stage.config.bias_n
        if not len(self._play):
            return still_n
        played = np.empty((len(u), len(self._play)), dtype=u.dtype)
        for k, begin in enumerate(to_scalars(self._play)):
            played[:, k] = play_operator(u, begin, self._stage.radius[k])
        self._play = played[-1]
        location = locate_on_curve(played, self._stage.config.n_intervals)
        for stop_n in evaluate_curves(self._stops, location).T:
            # A stop is P(u) - P(play); its P(u) is part of the spring's curve already.
            still_n = still_n - stop_n
        return still_n


class _DetachedTick:
    """Spring, branches and stops of a stage, tick after tick: the same bits as the arrays."""

    def __init__(self, stage: "HammersteinStage", curves: Reals, stops: Reals) -> None:
        self._real, self._stage = scalar_type(curves.dtype.type), stage
        self._pieces = self._real(count_intervals(stage.config.n_intervals))
        self._curves, self._stops = _list_pieces(curves), _list_pieces(stops)
        self._radius, self._bias_n = to_scalars(stage.radius), self._real(stage.config.bias_n)
        self._losses = [list(map(to_scalars, np.atleast_2d(step.loss))) for step in stage.steps]

    def begin(self, before: Reals, branch_state: list[Reals], play: Reals) -> None:
        self._before, self._play = to_scalars(before), to_scalars(play)
        self._branch_state = [to_scalars(states) for states in branch_state]

    def end(self, dtype: RealType) -> tuple[Reals, list[Reals], Reals]:
        """Return values of the branches' curves, their states, and plays, after the last tick."""
        types = (np.float64 if step.double else dtype for step in self._stage.steps)
        states = [np.array(h, dtype=t) for h, t in zip(self._branch_state, types, strict=True)]
        return np.array(self._before, dtype), states, np.array(self._play, dtype)

    def advance(self, u: Scalar) -> Scalar:
        """Return the force of one tick with the surface at u, N: by it the surface recovers."""
        interval, fraction = self._locate(u)
        still_n, *g = self._evaluate(self._curves[interval], fraction)
        rises = [now - last for now, last in zip(g, self._before, strict=True)]
        self._before, sums = g, [self._real(0)] * VECTOR_WIDTH
        for step, losses, states in zip(
            self._stage.steps, self._losses, self._branch_state, strict=True
        ):
            here = rises[step.first : step.first + step.count]
            _relax_by_tick(step, losses, states, here, (interval, fraction))
            for k, h in enumerate(states, step.first):
                sums[k % VECTOR_WIDTH] += self._real(h)
        still_n = still_n + self._bias_n
        for k, radius in enumerate(self._radius):
            low, high, p = u - radius, u + radius, self._play[k]
            p = self._play[k] = low if not p > low else p if p < high else high
            interval, fraction = self._locate(p)
            still_n = still_n - self._evaluate(self._stops[interval][k : k + 1], fraction)[0]
        return still_n + ((sums[0] + sums[2]) + (sums[1] + sums[3]))

    def _locate(self, u: Scalar) -> tuple[int, Scalar]:
        """`locate_on_curve` of one depth."""
        position = (u if u > 0 else self._real(0)) * self._pieces
        interval = int(min(position, self._stage.config.n_intervals - 1))
        return interval, position - self._real(interval)

    def _evaluate(self, piece: _Piece, fraction: Scalar) -> list[Scalar]:
        """`evaluate_curves` in one piece."""
        half = self._real(0.5) * fraction
        return [begin + fraction * (slope + half * rise) for begin, slope, rise in piece]


def _relax_by_tick(
    step: MaxwellBranches, losses: list[list[Scalar]], states: list[Scalar],
    rises: list[Scalar], location: tuple[int, Scalar],
) -> None:  # fmt: skip
    """Advance Maxwell branches by one tick, in place, in plain numbers."""
    rises = list(map(float, rises)) if step.double else rises
    (interval, fraction), real = location, type(rises[0])
    for k, (z, rise) in enumerate(zip(states, rises, strict=True)):
        if step.by_depth:
            begin = losses[interval][k]
            loss = real(begin + fraction * (losses[interval + 1][k] - begin))
            x = z + (rise - loss * (z + real(0.5) * rise))
        else:
            x = z + (rise - losses[0][k] * z)
        states[k] = x if x >= SMALLEST or x <= -SMALLEST else x * 0


def _list_pieces(nodes: Reals) -> list[_Piece]:
    """Value, slope, and rise of the slope of each curve, of each piece between nodes."""
    rise = nodes[1:, 1] - nodes[:-1, 1]
    pieces = zip(nodes[:-1, 0], nodes[:-1, 1], rise, strict=True)
    return [list(zip(*map(to_scalars, piece), strict=True)) for piece in pieces]


def _sum_branches(branch_n: Reals) -> Reals:
    """Sum the branches' forces, (n,), in four partial sums, in the order of the C's vectors."""
    s = np.zeros((VECTOR_WIDTH, len(branch_n)), dtype=branch_n.dtype)
    for first in range(0, branch_n.shape[1], VECTOR_WIDTH):
        vector = branch_n[:, first : first + VECTOR_WIDTH].T
        s[: len(vector)] += vector
    total: Reals = (s[0] + s[2]) + (s[1] + s[3])
    return total
