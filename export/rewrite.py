"""`python -m export.rewrite [skin.onnx]`: exported files in the form that export writes today.

Weights and metadata stay. A file is replaced only if its outputs are the same to the bit on
photographs of several sizes; then nothing that was measured with it has to be measured again.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import onnxruntime
from numpy.typing import NDArray
from skimage.data import astronaut

from export.onnx_graph import finish
from skinnet.errors import InputError
from skinnet.files import write_together
from skinnet.inference import CAPTURE_NAMES, MAP_NAMES, SHIPPED_ENCODER, open_model
from skinnet.inference._onnx_pair import get_decoder_path

CROPS = (np.s_[:200:2, 120:300:2], np.s_[::3, ::3], np.s_[:161, 140:301], np.s_[100:133, 200:237])
"""Of the astronaut: the head at half size, all, and odd sizes."""

Arrays = dict[str, NDArray[Any]]


def rewrite(encoder: Path) -> list[Path]:
    """Rewrite an encoder and its decoder in place.

    Args:
        encoder: The encoder's file.

    Returns:
        Both files.

    Raises:
        InputError: If a file cannot be used, or an output would change. Then no file is replaced.
    """
    paths = {"encoder": encoder, "decoder": get_decoder_path(encoder)}
    photo: NDArray[np.uint8] = astronaut()  # type: ignore[no-untyped-call]
    feeds: list[Arrays] = [{"image": np.ascontiguousarray(photo[crop])[None]} for crop in CROPS]
    with write_together() as temporary:
        for kind, path in paths.items():
            open_model(path, kind)
            feeds = _rewrite_one(path, temporary(path), feeds)
    return list(paths.values())


def _rewrite_one(path: Path, part: Path, feeds: list[Arrays]) -> list[Arrays]:
    """Write the new file to `part`; the results are the decoder's inputs."""
    model = onnx.load(path)
    finish(model)
    onnx.save(model, part)
    before, after = _run(path, feeds), _run(part, feeds)
    for old, new in zip(before, after, strict=True):
        if not all(np.array_equal(old[name], new[name], equal_nan=True) for name in old):
            raise InputError(f"{path} would change its outputs; it was left as it is.")
    names = (*MAP_NAMES, *CAPTURE_NAMES)
    return [{name: one[name] for name in names if name in one} for one in before]


def _run(path: Path, feeds: list[Arrays]) -> list[Arrays]:
    session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])
    names = [output.name for output in session.get_outputs()]
    return [dict(zip(names, session.run(None, feed), strict=True)) for feed in feeds]


def main(arguments: Sequence[str] | None = None) -> int:
    """Rewrite files; return 0, or 2 with a sentence on stderr for bad input."""
    parser = argparse.ArgumentParser(prog="python -m export.rewrite", description=__doc__)
    parser.add_argument(
        "encoder",
        type=Path,
        nargs="?",
        default=SHIPPED_ENCODER,
        metavar="FILE",
        help="an encoder, X.onnx, with X.decoder.onnx beside it; default: the shipped one",
    )
    try:
        for path in rewrite(parser.parse_args(arguments).encoder):
            print(f"{path}: {path.stat().st_size / 1e6:.2f} MB, the same outputs to the bit")
    except (InputError, OSError) as error:
        print(f"export: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
