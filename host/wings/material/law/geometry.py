"""Shear modulus of a stiffness, for the tips and clamps that press incompressible specimens."""

from dataclasses import dataclass
from math import isfinite, pi, radians, sqrt, tan
from typing import Literal

import numpy as np

from springpot import UsageError
from springpot.basics import Samples

Shape = Literal["flat", "sphere", "cone", "plates", "bonded-plates"]
_NARROW = 0.02  # of the depth: a needle, into which nothing soft is pressed without a cut
_MAX_TIP = 20  # diameter over height: beyond, 40 nodes are too few
_NODES = 40  # of the layer's integral equation
_POISSON = 0.5  # rubbers keep their volume
_KAPPA = 3.0 - 4.0 * _POISSON


@dataclass(frozen=True)
class Geometry:
    """What presses what: sizes in the options' mm and degrees, None where they are not given.

    tip_mm: diameter of a tip, or of the specimen between plates. depth_mm: about which a sphere or
    cone was pressed by little. cone_deg: between axis and side.

    >>> round(Geometry("flat", tip_mm=6.0).shear_pa_per_npm)
    42
    """

    shape: Shape = "flat"
    tip_mm: float | None = None
    height_mm: float | None = None
    depth_mm: float | None = None
    cone_deg: float | None = None

    @property
    def shear_pa_per_npm(self) -> float:
        """Shear modulus G of unit stiffness, 1/m. Raises UsageError for sizes.

        Any tip that is round about its axis, on a half space that keeps its volume: dF/dx = 8 G a,
        a the radius of contact (Sneddon 1965; Pharr, Oliver and Brotzen 1992); a flat tip on a
        layer is `layer_factor` stiffer. Plates: 3 G A / height, for a bonded disc times 1 + 2 S^2,
        S = diameter / (4 height) (Gent and Lindley 1959).
        """
        self._require_sizes()
        if self.shape in ("plates", "bonded-plates"):
            diameter_m, height_m = self._m("tip_mm"), self._m("height_mm")
            bonded = 2.0 * (diameter_m / (4.0 * height_m)) ** 2
            factor = 1.0 + (bonded if self.shape == "bonded-plates" else 0.0)
            return height_m / (3.0 * pi / 4.0 * diameter_m**2 * factor)
        if self.shape == "flat":
            radius_m = self._m("tip_mm") / 2.0
            layer = 1.0 if self.height_mm is None else layer_factor(radius_m / self._m("height_mm"))
            return 1.0 / (8.0 * radius_m * layer)
        if self.shape == "sphere":  # Hertz: a^2 = R x
            return 1.0 / (8.0 * sqrt(self._m("tip_mm") / 2.0 * self._m("depth_mm")))
        assert self.cone_deg is not None  # Sneddon: x = pi/2 a / tan(angle)
        return pi / (16.0 * self._m("depth_mm") * tan(radians(self.cone_deg)))

    @property
    def words(self) -> str:
        """What is taken for granted of the specimen, for people."""
        wide, high = (
            "" if size is None else f"{size:g} mm" for size in (self.tip_mm, self.height_mm)
        )
        if self.shape in ("plates", "bonded-plates"):
            how = "bonded to" if self.shape == "bonded-plates" else "sliding on"
            return f"{wide} wide, {high} high, {how} the plates"
        tip = f"flat tip of {wide}" if self.shape == "flat" else self.shape
        return f"{tip} on a wide " + (f"layer of {high}, bonded below" if high else "block")

    def require_plausible(self, depth_m: float) -> None:
        """Raise UsageError for sizes that nothing pressed so deep has: metres given as mm."""
        for name, min_m in (("height_mm", depth_m), ("tip_mm", _NARROW * depth_m)):
            if getattr(self, name) is not None and self._m(name) <= min_m:
                raise UsageError(
                    f"{_OPTIONS[name]} {getattr(self, name):g}: the recordings press "
                    f"{1e3 * depth_m:.3g} mm deep: give mm"
                )

    def _m(self, name: str) -> float:
        return 1e-3 * float(getattr(self, name))

    def _require_sizes(self) -> None:
        needed = _NEEDED[self.shape]
        for name, option in _OPTIONS.items():
            value = getattr(self, name)
            if value is None and name in needed:
                raise UsageError(f"--geometry {self.shape}: give {option} as well")
            if value is not None and not (isfinite(value) and value > 0.0):
                raise UsageError(f"{option} {value:g}: give a size above 0")
            if value is not None and name not in (*needed, *_MAY[self.shape]):
                raise UsageError(
                    f"{option}: --geometry {self.shape} has no such size: leave it out"
                )
        if self.cone_deg is not None and self.cone_deg >= 90.0:
            raise UsageError(f"--cone-deg {self.cone_deg:g}: the angle from axis to side: below 90")
        tip_mm, height_mm = self.tip_mm, self.height_mm
        wide = tip_mm is not None and height_mm is not None and tip_mm > _MAX_TIP * height_mm
        if wide and self.shape == "flat":
            raise UsageError(
                f"--height-mm {height_mm:g}: a tip of {tip_mm:g} mm is more than {_MAX_TIP} times "
                "as wide, beyond what the layer's equation is solved for: both are in mm"
            )
        if self.shape == "sphere" and tip_mm is not None and (self.depth_mm or 0.0) > tip_mm / 2.0:
            raise UsageError(
                f"--depth-mm {self.depth_mm:g}: deeper than the sphere's radius, {tip_mm / 2:g} mm"
            )


_OPTIONS = {
    "tip_mm": "--tip-mm", "height_mm": "--height-mm", "depth_mm": "--depth-mm",
    "cone_deg": "--cone-deg",
}  # fmt: skip
_NEEDED: dict[Shape, tuple[str, ...]] = {
    "flat": ("tip_mm",), "sphere": ("tip_mm", "depth_mm"), "cone": ("depth_mm", "cone_deg"),
    "plates": ("tip_mm", "height_mm"), "bonded-plates": ("tip_mm", "height_mm"),
}  # fmt: skip
_MAY: dict[Shape, tuple[str, ...]] = {
    "flat": ("height_mm",), "sphere": (), "cone": (), "plates": (), "bonded-plates": (),
}  # fmt: skip


def layer_factor(radius_per_height: float) -> float:
    """Return how much stiffer an incompressible layer on a rigid base is than a half space.

    The integral equation of Lebedev and Ufliand (1958) for a flat punch, as in Hayes et al.
    (1972), solved on Gauss-Legendre nodes. 1 for a thick specimen.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    t, w = 0.5 * (nodes + 1.0), 0.5 * weights
    # 1 - L falls as exp(-2 y): 20 heights are infinity.
    fine, fine_weights = np.polynomial.legendre.leggauss(400)
    y, dy = 10.0 * (fine + 1.0), 10.0 * fine_weights
    cosines = np.cos(radius_per_height * np.outer(t, y))
    kernel = radius_per_height * (cosines * ((1.0 - _layer_compliance(y)) * dy)) @ cosines.T
    phi = np.linalg.solve(np.eye(_NODES) - 2.0 / np.pi * kernel * w, np.ones(_NODES))
    return float(w @ phi)


def _layer_compliance(y: Samples) -> Samples:
    """Return compliance of a bonded layer against a half space's, wave number times height y."""
    above = 2.0 * _KAPPA * np.sinh(2.0 * y) - 4.0 * y
    below = 2.0 * _KAPPA * np.cosh(2.0 * y) + 4.0 * y**2 + 1.0 + _KAPPA**2
    compliance: Samples = above / below
    return compliance
