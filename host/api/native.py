"""The C on this machine and on boards: build, load, replay, measure.

>>> from springpot.emission import make_plan
>>> from springpot.native import Replay, built
>>> with built(make_plan(model, scene)) as library:
...     force_n, notes = Replay(library).run(press_m, 0 * press_m)
>>> force_n.shape == press_m.shape
True
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.host.native.c_library import CLibrary as CLibrary, load_c as load_c
    from springpot.host.native.compiler import (
        CompilerError as CompilerError,
        cache_folder as cache_folder,
        compiler_reason as compiler_reason,
        compiler_version as compiler_version,
        find_compiler as find_compiler,
        first_error as first_error,
        packaged_compiler as packaged_compiler,
    )
    from springpot.host.native.footprint import (
        Footprint as Footprint,
        measure_footprint as measure_footprint,
    )
    from springpot.host.native.machine import cpu_s as cpu_s, machine_metadata as machine_metadata
    from springpot.host.native.replay import (
        Replay as Replay,
        TickTimes as TickTimes,
        replayed as replayed,
        replayed_accuracy as replayed_accuracy,
    )
    from springpot.host.native.scene_library import (
        SceneLibrary as SceneLibrary,
        port_headers as port_headers,
        scene_prefix as scene_prefix,
    )
    from springpot.host.native.toolchain import (
        SOFT_DOUBLES as SOFT_DOUBLES,
        Toolchain as Toolchain,
        missing_tools as missing_tools,
        toolchain as toolchain,
    )
    from springpot.host.native.trial_build import built as built, written as written
    from springpot.host.wings.boards.boards import (
        Board as Board,
        default_board as default_board,
        missing as missing,
    )
    from springpot.host.wings.boards.emulator import run_batch as run_batch, steps as steps
    from springpot.runtime_c.paths import (
        INCLUDE as INCLUDE,
        PORT_BROWSER as PORT_BROWSER,
        PORT_MCU as PORT_MCU,
        PORT_WASM as PORT_WASM,
        PORT_WIRE as PORT_WIRE,
        SIM as SIM,
        SOURCE as SOURCE,
        flags as flags,
    )
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
