"""The motion of a tool: where it turns round."""

from springpot.codegen.arrays import Samples


def turning_points(position_m: Samples, min_m: float) -> list[int]:
    """Indices at which the motion turns round by at least `min_m`, with both ends."""
    turns, best, rising = [0], 0, None
    for k, value in enumerate(position_m.tolist()):
        if rising is None:
            if abs(value - position_m[0]) >= min_m:
                rising, best = value > position_m[0], k
        elif (value > position_m[best]) == rising and value != position_m[best]:
            best = k
        elif abs(value - position_m[best]) >= min_m:
            turns.append(best)
            rising, best = not rising, k
    return [*turns, best] if rising is not None else []
