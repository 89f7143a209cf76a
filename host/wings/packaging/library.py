"""What makes a scene in one file a library: of the Arduino IDE (library.properties, a sketch), of
PlatformIO (library.json)."""

import json
import re
from importlib.metadata import version

import numpy as np

from springpot.emission import Plan, filled, literal, state_bytes

_MAX_COUNT = 1023  # of analogRead, where nobody sets its resolution
PACKAGE = "springpot.host.wings.packaging"  # its templates
_WHAT = "the feel of a recorded soft object, one force a tick"


def arduino_properties(plan: Plan) -> str:
    """library.properties of a library whose sources lie in its root."""
    prefix = plan.scene.runtime.prefix
    properties = {
        "name": prefix,
        "version": version("springpot"),
        "author": "springpot",
        "maintainer": "springpot",
        "sentence": f"{plan.scene.name}: {_WHAT}.",
        "paragraph": f"Call {prefix}_selftest() once, {prefix}_step() {1.0 / plan.dt_s:g} times a "
        f"second; {prefix}.h says all.",
        "category": "Device Control",
        "url": "",
        "architectures": "*",
        "includes": f"{prefix}.h",
    }
    return "".join(f"{key}={value}\n" for key, value in properties.items())


def platformio_manifest(plan: Plan) -> str:
    """library.json; a registry's names have dashes, and PlatformIO would build the examples too."""
    prefix = plan.scene.runtime.prefix
    fields = {
        "name": re.sub("_+", "-", prefix).strip("-"),
        "version": version("springpot"),
        "description": f"{plan.scene.name}: {_WHAT}."[:255],
        "keywords": ["haptics", "force feedback", "soft objects"],
        "frameworks": "*",
        "platforms": "*",
        "headers": f"{prefix}.h",
        "build": {
            "srcDir": ".",
            "includeDir": ".",
            "srcFilter": [f"+<{prefix}.c*>"],
            "flags": ["-ffp-contract=off", "-fno-math-errno"],
        },
    }
    return json.dumps(fields, indent=2) + "\n"


def arduino_sketch(plan: Plan) -> str:
    """A loop on an analog position and a PWM or DAC force; no force after a failed self-test."""
    number = plan.dtype
    period_us = round(1e6 * plan.dt_s)
    exact = abs(period_us - 1e6 * plan.dt_s) < 1e-6 * period_us
    says = "" if exact else f" /* the scene's is {1e6 * plan.dt_s:.6g}: as near as micros() is */"
    needs = plan.needs_device_velocity
    trained = plan.model.trained
    return filled(
        "loop.ino",
        plan,
        PACKAGE,
        NAME=plan.scene.name,
        STATE=str(state_bytes(plan)),
        PER_COUNT=literal(number(f"{(trained.max_m - min(trained.min_m, 0)) / _MAX_COUNT:.3g}")),
        FULL=literal(number(f"{float(plan.output.max_n):.3g}")),
        PERIOD_US=f"{period_us}u;{says}",
        PER_US=literal(number(1e-6)),
        ZERO=literal(number(0.0)),
        BEFORE=f"static {plan.real} before_m = {literal(number(0.0))};\n" if needs else "",
        DIFFERENCE=(
            f"    const {plan.real} velocity_mps = (position_m - before_m) * "
            f"{literal(number(np.float64(1.0 / plan.dt_s)))};\n    before_m = position_m;\n"
            if needs
            else ""
        ),
        VELOCITY="velocity_mps" if needs else literal(number(0.0)),
    )
