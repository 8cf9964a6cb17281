"""Where the files of the page are; models and the sample are those of the packages."""

from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from skinnet.errors import InputError
from skinnet.inference._onnx_pair import get_decoder_path
from skinnet.inference.onnx_model import SHIPPED_ENCODER

_PACKAGE = Path(__file__).parents[2]

_FACE_MODELS = _PACKAGE / "images" / "faces" / "models"

_PLACES = Path(__file__).parent / "page", _PACKAGE.parent / "web"
"""Where the page is in a wheel, and in a checkout."""

RUNTIME_FILES = "ort.wasm.bundle.min.mjs", "ort-wasm-simd-threaded.wasm.gz"
"""Files of ONNX Runtime Web in the page's folder `runtime`."""

_TYPES = {
    ".css": "text/css; charset=utf-8",
    ".gz": "application/gzip",
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".mjs": "text/javascript; charset=utf-8",
    ".onnx": "application/octet-stream",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
}
"""MIME types; those of the operating system may be others, which browsers refuse."""


class PageFile(NamedTuple):
    """A file of the page.

    Attributes:
        path: Where it is.
        type: Its MIME type.
    """

    path: Path
    type: str


def list_files() -> dict[str, PageFile]:
    """List all files of the page by their address, which begins with a slash.

    Raises:
        InputError: The page or its runtime is not installed.
    """
    page = _find_page()
    own = {
        f"/{file.relative_to(page).as_posix()}": file
        for file in sorted(page.rglob("*"))
        if file.suffix in _TYPES
    }
    missing = [name for name in RUNTIME_FILES if f"/runtime/{name}" not in own]
    if missing:
        raise InputError(
            f"The page lacks ONNX Runtime Web ({', '.join(missing)}). In a checkout, "
            "`make runtime` fetches it, which needs npm; or install a skinnet wheel "
            "that was built with it."
        )
    paths = {"/": page / "index.html", **own, **_list_models(), **_list_samples()}
    return {address: PageFile(path, _TYPES[path.suffix]) for address, path in paths.items()}


def _find_page() -> Path:
    for place in _PLACES:
        if (place / "index.html").is_file():
            return place
    raise InputError("The web page is not installed; install skinnet anew, from a wheel.")


def _list_models() -> dict[str, Path]:
    shipped = SHIPPED_ENCODER, get_decoder_path(SHIPPED_ENCODER)
    models = [*shipped, *_FACE_MODELS.glob("*.onnx")]
    return {f"/models/{path.name}": path for path in models}


def _list_samples() -> dict[str, Path]:
    """NASA's portrait of Eileen Collins, in the public domain, which scikit-image brings."""
    found = find_spec("skimage")
    assert found is not None and found.origin is not None, "scikit-image is a dependency"
    return {"/samples/astronaut.png": Path(found.origin).parent / "data" / "astronaut.png"}
