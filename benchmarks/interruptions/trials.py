"""Trials: a fault strikes, what is left is checked, and the same command is given again."""

import random
import re
import shutil
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from benchmarks.interruptions.disk import Disk
from benchmarks.interruptions.faults import FULL, KILL, READ_ONLY, Fault
from benchmarks.interruptions.files import Files, find_partial, read_files
from benchmarks.interruptions.processes import Outcome, Runner
from benchmarks.interruptions.scenes import Scene

_SWEPT = "partial files of an interrupted run were removed"
_FINISHED = "No step was taken"
"""Training was killed after its last checkpoint."""

_RENAMED = re.compile(r"run\.\d+/")
"""Where training keeps earlier runs."""


class Trial(NamedTuple):
    """A fault, and what was wrong after it; nothing if all was well."""

    scene: str
    fault: Fault
    faults: tuple[str, ...]


class Reference(NamedTuple):
    """A run without a fault.

    Attributes:
        before: The files that lay there before.
        after: The files afterwards.
        checked: What the scene's own check returns.
        outcome: The run.
        bytes: The bytes of the files that it wrote.
    """

    before: Files
    after: Files
    checked: Any
    outcome: Outcome
    bytes: int


class Stage:
    """A scene on a disk, where faults can strike it.

    Args:
        scene: The scene.
        root: A folder for its inputs, its disk and its log.
    """

    def __init__(self, scene: Scene, root: Path) -> None:
        self.scene, self.inputs, self.kept = scene, root / "inputs", root / "before"
        output = root / "output"
        for folder in (self.inputs, self.kept, output):
            folder.mkdir()
        scene.prepare(self.inputs)
        self.disk = Disk(output)
        self.output = output
        self.runner = Runner(root / "log.txt", output, self.disk.mounted)
        try:
            self.reference = self._run_reference()
        except BaseException:
            self.disk.close()
            raise

    def _run_reference(self) -> Reference:
        self._demand(self.runner.run(self.scene.before(self.inputs, self.output)))
        (self.output / "notes.txt").write_text("a file of the user")
        shutil.copytree(self.output, self.kept, dirs_exist_ok=True)
        self.disk.restore(self.kept)
        before = read_files(self.output)
        outcome = self.runner.run(self.scene.commands(self.inputs, self.output))
        self._demand(outcome)
        checked, after = self.scene.check(self.output), read_files(self.output)
        new = [name for name, digest in after.items() if before.get(name) != digest]
        size = sum((self.output / name).stat().st_size for name in new)
        return Reference(before, after, checked, outcome, size)

    def _demand(self, outcome: Outcome) -> None:
        if outcome.code:
            raise RuntimeError(f"{self.scene.name} without a fault: {outcome.said}")

    def try_fault(self, fault: Fault) -> Trial:
        """Let a fault strike a run; check what is left, and that the next run heals it."""
        outcome = self._strike(fault)
        while fault.kind == FULL and outcome.code == 0 and fault.size:  # all of it had room
            fault = fault._replace(size=fault.size // 2)
            outcome = self._strike(fault)
        partial = find_partial(self.output)
        faults = [*self._check_files(), *_check_outcome(outcome, fault, partial)]
        self.disk.limit()
        again = self.runner.run(
            (self.scene.resume or self.scene.commands)(self.inputs, self.output)
        )
        faults += self._check_again(again, partial)
        return Trial(self.scene.name, fault, tuple(faults))

    def _strike(self, fault: Fault) -> Outcome:
        self.disk.restore(self.kept)
        self.disk.limit(fault.size)
        return self.runner.run(self.scene.commands(self.inputs, self.output), fault)

    def _check_files(self) -> Iterator[str]:
        """Each file is the earlier one, the new one, or not there; earlier ones are not lost."""
        found, known = read_files(self.output), self.reference
        for name, digest in found.items():
            if _RENAMED.match(name) or "/stack/" in name:
                continue  # an earlier run under another name; subjects that wait for the others
            if digest == "damaged" or (
                not name.endswith((".ckpt", "report.html"))  # of fewer steps, of fewer photographs
                and digest not in (known.before.get(name), known.after.get(name))
            ):
                yield f"{name} is neither the earlier file nor the new one"
        contents = {*found.values()}
        for name, digest in known.before.items():
            replaced = name.endswith("report.html") and name in found
            if digest not in contents and found.get(name) != known.after.get(name) and not replaced:
                yield f"{name} is lost"

    def _check_again(self, outcome: Outcome, partial: list[str]) -> Iterator[str]:
        """The next run ends as one without a fault, and removes and names what was left."""
        if outcome.code and _FINISHED not in outcome.said:
            yield f"the next run ends with {outcome.code}: {_shorten(outcome.said)}"
            return
        found = read_files(self.output)
        for name, digest in self.reference.after.items():
            if found.get(name) != digest:
                yield f"after the next run {name} differs"
        for name in found.keys() - self.reference.after.keys():
            if not _RENAMED.match(name):
                yield f"after the next run {name} is there"
        yield from (f"{name} stays" for name in find_partial(self.output))
        if partial and _SWEPT not in outcome.said:
            yield f"{len(partial)} partial files are removed in silence"
        try:
            checked, expected = self.scene.check(self.output), self.reference.checked
            # A table keeps the rows that name what could not be written.
            same = expected <= checked if isinstance(expected, set) else expected == checked
            if not same:
                yield "numbers differ from those of a run without a fault"
        except ValueError as error:
            yield str(error)


def _check_outcome(outcome: Outcome, fault: Fault, partial: list[str]) -> Iterator[str]:
    if fault.kind == KILL:
        return
    if outcome.code == 0:
        yield "the fault was not noticed"
    elif outcome.code != 2 or "Traceback" in outcome.said or "Exception ignored" in outcome.said:
        yield f"it ends with {outcome.code}: {_shorten(outcome.said)}"
    elif not re.search(r"\((No space|Read-only|File too large)[^)]*\); ", outcome.said):
        yield f"no sentence names the disk: {_shorten(outcome.said)}"
    if fault.kind == FULL:
        yield from (f"{name} is left" for name in partial)


def _shorten(said: str) -> str:
    lines = [line for line in said.splitlines() if line.strip()]
    return " | ".join(lines[-6:])[-1500:]


def list_faults(kind: str, count: int, reference: Reference, rng: random.Random) -> Iterable[Fault]:
    """List faults of one kind, spread over a run at random.

    Half of the kills strike at random times, half before random writes.
    """
    outcome = reference.outcome
    shares = [(index + rng.random()) / count for index in range(count)]
    if kind == READ_ONLY:
        return [Fault(kind, write=int(share * outcome.writes)) for share in shares]
    if kind == FULL:
        return [Fault(kind, size=int(share * reference.bytes)) for share in shares]
    return [
        Fault(kind, seconds=share * outcome.seconds)
        if index % 2
        else Fault(kind, write=int(share * outcome.writes))
        for index, share in enumerate(shares)
    ]


def run_trials(
    scene: Scene, counts: dict[str, int], seed: int, tell: Callable[[Trial], None]
) -> list[Trial]:
    """Run a scene with so many faults of each kind.

    Args:
        scene: The scene.
        counts: Number of faults by kind.
        seed: Seed of the moments.
        tell: Called with each trial.
    """
    trials = []
    with TemporaryDirectory(prefix="skinnet-") as folder:
        stage = Stage(scene, Path(folder))
        try:
            rng = random.Random(f"{seed} {scene.name}")
            for kind, count in counts.items():
                for fault in list_faults(kind, count, stage.reference, rng):
                    trials.append(stage.try_fault(fault))
                    tell(trials[-1])
        finally:
            stage.disk.close()
    return trials


KINDS = (KILL, FULL, READ_ONLY)
