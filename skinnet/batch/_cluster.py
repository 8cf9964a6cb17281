"""Ray on this machine or on a cluster: started without noise, reached within a bounded time."""

import logging
import os
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext, redirect_stdout
from typing import Any, TextIO, cast

from skinnet.batch._guard import end_together
from skinnet.batch._job import Job
from skinnet.batch._worker import Worker
from skinnet.errors import InputError
from skinnet.inference._messages import explain

_SECONDS = 60
"""Time for a cluster to answer; Ray itself waits for minutes."""

_STORE = 100_000_000
"""Bytes of Ray's memory for objects on this machine: numbers of blocks alone pass through it."""

_QUIET = {
    "RAY_USAGE_STATS_ENABLED": "0",
    "RAY_DATA_DISABLE_PROGRESS_BARS": "1",
    "RAY_BACKEND_LOG_LEVEL": "fatal",
}


@contextmanager
def connect(address: str | None) -> Iterator[int]:
    """Start Ray on the cores of this machine, or connect to a cluster.

    Args:
        address: HOST:PORT of a cluster, or auto for the one on this machine; None for the
            environment variable RAY_ADDRESS, or a Ray of one's own.

    Yields:
        The number of cores.

    Raises:
        InputError: Ray is not installed, or the cluster does not answer.
    """
    ray = import_ray()
    address = address or os.environ.get("RAY_ADDRESS") or "local"
    own = address == "local"
    if not own:
        _check_address(address)
    store = {"object_store_memory": _STORE, "include_dashboard": False} if own else {}
    with end_together() if own else nullcontext():
        try:
            with _hush():
                ray.init(address, log_to_driver=False, logging_level=logging.ERROR, **store)
        except (ConnectionError, RuntimeError, ValueError, OSError) as error:
            raise InputError(_describe(address, str(error))) from error
        with redirect_stdout(cast(TextIO, _Log())):
            try:
                yield max(1, int(ray.cluster_resources().get("CPU", 1)))
            finally:
                ray.shutdown()


def import_ray() -> Any:
    """Import Ray.

    Raises:
        InputError: It is not installed.
    """
    os.environ.update({name: os.environ.get(name, value) for name, value in _QUIET.items()})
    try:
        import ray
        import ray.data  # noqa: F401  # `import ray` alone does not load it
    except ModuleNotFoundError as error:
        raise InputError(
            'python -m skinnet.batch needs the ray extra: pip install "skinnet[ray]"'
        ) from error
    return ray


def read_blocks(job: Job, count: int, workers: int | None, cores: int) -> Iterator[tuple[int, str]]:
    """Have the workers of the cluster read blocks.

    Ray starts a worker that died again, and gives it its block again; after the death of a machine
    it does so on another one.

    Args:
        job: What the workers are told.
        count: Number of blocks.
        workers: Most workers; None for as many as the cluster has cores.
        cores: Cores of the cluster.

    Yields:
        The number of each block that is done, and why it could not be written, if so.

    Raises:
        InputError: Ray has failed.
    """
    ray = import_ray()
    context = ray.data.DataContext.get_current()
    context.enable_progress_bars = False
    context.print_on_execution_start = False
    for name in ("ray", "ray.data"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    # A block of Ray for each of ours: a worker that dies repeats one, and not several.
    blocks = ray.data.from_items([{"block": n} for n in range(count)], override_num_blocks=count)
    most = min(count, workers or count)
    pool = ray.data.ActorPoolStrategy(
        min_size=1,  # so that idle workers make room for those of a machine that died
        initial_size=min(most, cores),
        max_size=most,
        max_tasks_in_flight_per_actor=2,
    )
    done = blocks.map_batches(
        Worker, batch_size=1, compute=pool, num_cpus=1, fn_constructor_args=(job,)
    )
    try:
        for row in done.iter_rows():
            yield int(row["block"]), str(row["fault"])
    except ray.exceptions.RayError as error:
        raise InputError(_describe_failure(error)) from error


class _Log:
    """Takes what Ray prints among the results, such as that a worker died; -v shows it."""

    def write(self, text: str) -> int:
        """Print lines to standard error."""
        for line in re.sub(r"\x1b\[\d*m", "", text).splitlines():
            if line.strip():
                explain(line.strip())
        return len(text)

    def flush(self) -> None:
        """Nothing waits."""


@contextmanager
def _hush() -> Iterator[None]:
    """Keep from standard error what Ray's own process prints there while it starts."""
    kept = os.dup(2)
    try:
        with open(os.devnull, "wb") as nothing:
            os.dup2(nothing.fileno(), 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def _check_address(address: str) -> None:
    """Ask a cluster for a sign of life, in a process that can be ended."""
    if address.startswith("ray://"):
        raise InputError(
            f"{address} is the address of a Ray client; run this command on a machine of the "
            "cluster with --address auto, or by ray job submit."
        )
    known = [] if address == "auto" else ["--address", address]
    command = [sys.executable, "-m", "ray.scripts.scripts", "health-check", *known]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_SECONDS)
    except subprocess.TimeoutExpired as error:
        raise InputError(_describe(address, f"no answer in {_SECONDS} seconds")) from error
    if done.returncode:
        raise InputError(_describe(address, done.stderr))


def _describe(address: str, reason: str) -> str:
    words = _find_last(reason.strip().splitlines())
    return (
        f"The Ray cluster at {address} cannot be used ({words}); check the address, and that "
        "ray status works there."
    )


def _describe_failure(error: Exception) -> str:
    text = str(error)
    if "No module named 'skinnet" in text:
        return 'A machine of the cluster has no skinnet; install "skinnet[ray]" on all of them.'
    return (
        f"Ray ended with {type(error).__name__}: {_find_last(text.strip().splitlines())}. What is "
        "written stays; the same command reads the rest."
    )


def _find_last(lines: Sequence[str]) -> str:
    return " ".join(lines[-1].split())[:200].rstrip(".") if lines else "no reason given"
