"""Jobs on all cores by joblib, or on a Dask cluster by joblib's own back end."""

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

from joblib import Parallel, delayed, parallel_config

from springpot.codegen.errors import UsageError

_CONNECT_S = 10
_WATCH_S = 0.5
Item = TypeVar("Item")
_Result = TypeVar("_Result")


def in_parallel(
    work: Callable[[Item], _Result], items: Sequence[Item], dask: str | None
) -> Iterator[_Result]:
    """Yield results as they come, in any order. dask: address of a scheduler.

    Raises UsageError where no scheduler answers there.
    """
    with _backend(dask):
        with _interrupts_held():  # workers start here, and inherit it
            results = Parallel(n_jobs=-1, return_as="generator_unordered", batch_size=1)(
                delayed(_in_one_thread)(work, item) for item in items
            )
        yield from results


def _in_one_thread(work: Callable[[Item], _Result], item: Item) -> _Result:
    """Keep the forests of a job from starting threads: every core has a job already."""
    with parallel_config(backend="sequential"):
        return work(item)


def _end_with(parent: int) -> None:
    """End this worker soon after its parent, however that ended: joblib's own would work on.

    A signal of the kernel's (PR_SET_PDEATHSIG) would come when the parent's thread ends, too.
    """

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(_WATCH_S)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Block Ctrl-C, which goes to every process of a terminal: the parent's answer is enough."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _backend(dask: str | None) -> Iterator[None]:
    if dask is None:
        with parallel_config(backend="loky", initializer=_end_with, initargs=(os.getpid(),)):
            yield
        return
    from distributed import Client

    try:
        client: Any = Client(dask, timeout=_CONNECT_S)
    except (OSError, ValueError) as error:
        raise UsageError(
            f"--dask {dask}: no scheduler answers ({error}): start one with `dask scheduler`, and "
            "`dask worker ADDRESS` on each machine that has springpot"
        ) from None
    with client, parallel_config(backend="dask"):
        yield
