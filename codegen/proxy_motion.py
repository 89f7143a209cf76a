"""Reference of a coupling with a proxy that the model sees: the model's force moves the proxy."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from springpot.codegen.arrays import Flags, Reals
from springpot.codegen.coupling.gains import CoupleConfig
from springpot.codegen.plan import Plan
from springpot.codegen.stages.stage import Starts, clamp_state
from springpot.codegen.tool_motion import ToolMotion
from springpot.codegen.types import Scalar

ModelForce = Callable[[int, Reals, Starts, Flags], Reals]
_CHUNK = 1024  # ticks predicted at a time, at most
_MIN_CHUNK = 8  # at least: a pass has a cost of its own
_CHUNK_GROWTH = 4  # times the ticks that the last pass verified


@dataclass(frozen=True, eq=False)
class ContactTrace:
    """Run as the coupling sees it: the tool's motion, and whether it is in contact, (rows,)."""

    motion: ToolMotion
    contact: Flags

    @property
    def proxy_starts(self) -> Flags:
        """Rows, (rows,), that set the proxy to the tool: contact begins, or history restarts."""
        begins = self.contact & ~np.concatenate([[False], self.contact[:-1]])
        starts = self.motion.starts
        begins[starts] = self.contact[starts]
        return np.asarray(begins)


def simulate_proxy(
    plan: Plan, trace: ContactTrace, force: ModelForce, predicted_m: Reals | None
) -> Reals:
    """Position at which the model looks at each tick, (n,), m: the proxy, or the tool in free air.

    Predict and verify: the stages' references take whole motions, but the proxy's next position
    needs the force here. So the force is evaluated on a predicted motion and the proxy stepped
    with it: every tick up to the first that differs is exact, because its past was; what follows
    is a better prediction. A pass begins at the last restart, which forgets what came before, and
    goes a few times as far as the last one verified: in a stiff object one wrong tick spoils the
    rest of a long prediction.
    force(first, motion, starts, asked): the model's force, (n,), N, on a motion (n,), m, from the
    tick `first` on, where `asked`.
    predicted_m: (n,), the motion that the C reports, with which one pass is enough.
    """
    stepper = _ProxyStepper(plan, trace)
    path_m = trace.motion.position.copy()
    if predicted_m is not None:
        predicted = trace.contact & ~trace.proxy_starts
        path_m[predicted] = predicted_m[predicted]
    total = len(path_m)
    # The first prediction is the tool: a proxy that is placed begins there.
    done, chunk = 0, _CHUNK if predicted_m is None else total
    while done < total:
        end = min(total, done + chunk)
        starts = trace.motion.starts
        begin = int(starts[starts <= done].max(initial=0))
        asked = trace.contact[begin:end].copy()
        asked[: done - begin] = False  # verified: only the features' past
        starts = starts[(starts >= begin) & (starts < end)] - begin
        motion = path_m[begin:end]
        model_n = apply_onset_and_fade(plan, motion, force(begin, motion, starts, asked))
        verified = stepper.verify(path_m, model_n[done - begin :], done, end)
        chunk = min(_CHUNK, max(_MIN_CHUNK, _CHUNK_GROWTH * (verified - done)))
        done = verified
    return path_m


def apply_onset_and_fade(plan: Plan, pressed: Reals, model_n: Reals) -> Reals:
    """sp_range_fade and sp_contact.h: the model's force at border and surface, (n,), N."""
    zero, one = model_n.dtype.type(0), model_n.dtype.type(1)
    if plan.fade_per_m is not None:
        beyond = np.maximum(pressed - plan.range.max_m, plan.range.min_m - pressed)
        share = one - beyond * plan.fade_per_m
        fading = np.where(share > 0, model_n * share, zero)
        model_n = np.where(beyond > 0, fading, model_n)
    if plan.onset_per_m is not None:
        share = pressed * plan.onset_per_m
        rising = np.where(share < 1, model_n * share, model_n)
        model_n = np.where(share > 0, rising, zero)
    return model_n


class VirtualCoupling:
    """sp_couple.h: Algorithm 1, stepped exactly."""

    def __init__(self, config: CoupleConfig) -> None:
        self._config = config
        self.proxy: tuple[Scalar, Scalar] | None = None

    def start_proxy(self, x: Scalar, v: Scalar) -> Scalar:
        """Position of the proxy, m, which exists from here on."""
        self.proxy = self.proxy or (x, v)
        return self.proxy[0]

    def force(self, x: Scalar, v: Scalar, model_n: Scalar) -> Scalar:
        """Return the force at the tool, N, and move the proxy by a tick (sp_couple.h)."""
        config = self._config
        self.start_proxy(x, v)
        assert self.proxy is not None
        proxy_m, proxy_mps = self.proxy
        e = proxy_m - x
        w = proxy_mps - v
        force_n = -(config.stiffness_npm * e) - config.damping_nspm * w
        rest = -(config.compliance_mpn * model_n)
        from_rest = e - rest
        phi = config.phi
        self.proxy = (
            clamp_state(x + config.dt_s * v + (rest + (phi[0] * from_rest + phi[1] * w))),
            clamp_state(v + (phi[2] * from_rest + phi[3] * w)),
        )
        return force_n


class _ProxyStepper:
    def __init__(self, plan: Plan, trace: ContactTrace) -> None:
        assert plan.couple is not None
        self._coupled = VirtualCoupling(plan.couple)
        self._guard = plan.guard
        self._trace = trace
        self._placed = trace.proxy_starts

    def verify(self, pressed: Reals, model_n: Reals, begin: int, end: int) -> int:
        """Step the proxy through ticks begin .. end with forces that were computed on a prediction.

        Corrects `pressed` and returns the first tick whose prediction was wrong: from there on the
        forces have to be computed again. model_n: (ticks,). Ticks after a wrong one are stepped
        too: their motion is the next prediction.
        """
        verified = end
        for i in range(begin, end):
            proxy = self._coupled.proxy
            if self._tick(pressed, model_n[i - begin], i) and verified == end:
                verified, at_proof = i, proxy
        if verified < end:  # the next pass steps that tick again, from the proxy before it
            self._coupled.proxy = at_proof
        return verified

    def _tick(self, pressed: Reals, model_n: Scalar, i: int) -> bool:
        """One tick; returns whether the predicted position was wrong."""
        trace = self._trace
        if self._placed[i] or not trace.contact[i]:
            self._coupled.proxy = None
        if not trace.contact[i]:
            return False
        x, v = trace.motion.position[i], trace.motion.velocity[i]
        proxy_m = np.clip(self._coupled.start_proxy(x, v), self._guard.min_m, self._guard.max_m)
        # A NaN that was predicted is right: two of them are the same motion.
        wrong = bool(proxy_m != pressed[i]) and not (np.isnan(proxy_m) and np.isnan(pressed[i]))
        pressed[i] = proxy_m
        self._coupled.force(x, v, model_n)
        return wrong
