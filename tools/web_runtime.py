"""Fetches the libraries of the page: `python -m tools.web_runtime`.

`npm pack` downloads pinned releases from the npm registry: ONNX Runtime Web, which runs the
networks, and Mediabunny, which takes videos apart for the browser's decoder. Some of their files
are checked, and written to `web/runtime`, which git ignores and the wheel takes along: modules as
they are, and the WebAssembly compressed, which makes 14 MB to 4. The page decompresses it.
"""

import gzip
import hashlib
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ORT, MEDIABUNNY = "onnxruntime-web@1.30.0", "mediabunny@1.61.0"

PACKAGES = {
    ORT: {
        "dist/ort.wasm.bundle.min.mjs": (
            "11e64bd8ffe11bd1a2a2f0d6275fdfbbba7262f0b76b99b53d228a8a22ef3d90"
        ),
        "dist/ort-wasm-simd-threaded.wasm": (
            "3398c10d07d229bd91b364548e130e0e51a8e5704b88c7c083ebbeb78842dee2"
        ),
    },
    MEDIABUNNY: {
        "dist/bundles/mediabunny.min.mjs": (
            "fa696c53494b6b09a8b310ec51e3c44a59e79513234fb832255a38c686162009"
        ),
    },
}
"""The files that are taken from each package, with their SHA-256."""

TARGET = Path(__file__).parents[1] / "web" / "runtime"

_STAMP = "package.txt"
"""The file that names the packages that were fetched; it is written last."""


class FetchError(Exception):
    """The runtime cannot be fetched; the message is a sentence for the user."""


def main() -> int:
    """Fetch the runtime if it is not there; without npm the page is left out, in a sentence."""
    if _is_fetched():
        return 0
    try:
        fetch(TARGET)
    except FetchError as error:
        print(f"web_runtime: {error}", file=sys.stderr)
        return 1
    return 0


def fetch(target: Path) -> None:
    """Download the packages, and write their checked files.

    Args:
        target: The folder to write to.

    Raises:
        FetchError: npm is missing or fails, or a file is another one than was tried.
    """
    npm = shutil.which("npm")
    if npm is None:
        raise FetchError(
            f"npm is not installed, and the web page needs {' and '.join(PACKAGES)}; install "
            "Node.js with npm, and run this again. All else works without it."
        )
    contents: dict[str, bytes] = {}
    for package in PACKAGES:
        contents |= _download(npm, package)
    target.mkdir(parents=True, exist_ok=True)
    for name, content in contents.items():
        if name.endswith(".wasm"):
            name, content = f"{name}.gz", gzip.compress(content, mtime=0)
        (target / name).write_bytes(content)
    (target / _STAMP).write_text(_make_stamp(), encoding="utf-8")


def _download(npm: str, package: str) -> dict[str, bytes]:
    """The checked files of a package by their names."""
    with tempfile.TemporaryDirectory() as folder:
        command = [npm, "pack", "--silent", package, "--pack-destination", folder]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        packed = next(Path(folder).glob("*.tgz"), None)
        if done.returncode or packed is None:
            reason = (done.stderr.strip().splitlines() or ["no reason"])[-1]
            raise FetchError(f"npm did not download {package} ({reason}); is there a network?")
        return _read_files(packed, package)


def _read_files(packed: Path, package: str) -> dict[str, bytes]:
    contents = {}
    with tarfile.open(packed) as archive:
        for path, checksum in PACKAGES[package].items():
            name = Path(path).name
            member = archive.extractfile(f"package/{path}")
            contents[name] = b"" if member is None else member.read()
            found = hashlib.sha256(contents[name]).hexdigest()
            if found != checksum:
                raise FetchError(f"{name} of {package} has the SHA-256 {found}, not {checksum}.")
    return contents


def _make_stamp() -> str:
    return "".join(f"{package}\n" for package in PACKAGES)


def _is_fetched() -> bool:
    stamp = TARGET / _STAMP
    return stamp.is_file() and stamp.read_text(encoding="utf-8") == _make_stamp()


if __name__ == "__main__":
    sys.exit(main())
