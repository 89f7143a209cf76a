"""Names for what Python's types cannot tell apart."""

from collections.abc import Mapping
from typing import Any

JsonObject = dict[str, Any]  # an object of JSON: metadata, the keys that a command prints
JsonMapping = Mapping[str, Any]  # the same, only read
RealType = type[Any]  # float32 or float64, a scene's numbers
Scalar = Any  # one number of a scene's type, of numpy or Python
CData = Any  # what cffi makes of C
