"""`python -m export CHECKPOINT -o skin.onnx`."""

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from skinnet.errors import InputError, _explain_missing
from skinnet.inference._command.assumptions import describe_versions
from skinnet.inference._command.spelling import spell_flags
from skinnet.inference._command.verb_parser import VerbParser, read_verbosity
from skinnet.inference._messages import (
    explain,
    keep_verbosity,
    log,
    note_removed,
    open_missing_streams,
    print_line,
    quit_at_interrupt,
    report,
    set_verbosity,
)

_DESCRIPTION = (
    "Write a checkpoint as ONNX, compared with torch: the encoder to FILE, and beside it the "
    "decoder, .decoder.onnx, and the weights, .safetensors."
)
_EXAMPLES = (
    ("python -m export runs/quick/best.ckpt -o skin.onnx", "encoder, decoder and weights"),
    ("python -m export runs/quick/best.ckpt -o small.onnx --half", "in half precision"),
)
_PACKAGES = ("numpy", "torch", "onnx", "onnxscript", "onnxruntime")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the flags of the command."""
    parser.add_argument("checkpoint", type=Path, help="a .ckpt of training, or .safetensors")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="the encoder's file; by default skin.onnx. Files of another checkpoint are not "
        "replaced",
    )
    parser.add_argument(
        "--half",
        action="store_true",
        help="round the encoder's weights to half precision; .safetensors stores them as float16",
    )
    parser.add_argument(
        "--json", action="store_true", help="print each file as one line of JSON, nothing else"
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Export a checkpoint; return 0, or 2 with a sentence on stderr for bad input."""
    open_missing_streams()
    with keep_verbosity():
        return _run(list(sys.argv[1:] if arguments is None else arguments))


def _run(arguments: list[str]) -> int:
    try:
        parser = VerbParser("python -m export", _DESCRIPTION, _EXAMPLES, add_arguments)
        options = parser.parse(spell_flags(arguments))
        set_verbosity(read_verbosity(options))
        explain(describe_versions(_PACKAGES))
        _export(options)
    except ModuleNotFoundError as error:
        sentence = _explain_missing(error, "export", "python -m export", '-e ".[export]"')
        report(sentence, "export")
        return 2
    except (InputError, OSError) as error:
        report(error, "export")
        return 2
    except KeyboardInterrupt:
        return 130
    finally:
        note_removed()
    return 0


def _export(options: argparse.Namespace) -> None:
    # Imported here, so that --help does not wait for torch.
    with quit_at_interrupt():
        from export.onnx_file import SIZES, export_model
        from export.outputs import DEFAULT, choose_output, describe_checkpoint
        from skinnet.network import SkinAutoencoder

    checkpoint, given, half = options.checkpoint, options.output, options.half
    output = given or DEFAULT
    if output.suffix != ".onnx":
        raise InputError(f"{output} does not end in .onnx; name the file that is to be written.")
    if output.is_dir():
        raise InputError(f"{output} is a folder; name the file that is to be written.")
    if not output.parent.is_dir():
        raise InputError(f"{output.parent} is not a folder; make it first.")
    if checkpoint.resolve() == output.with_suffix(".safetensors").resolve():
        raise InputError(
            f"{checkpoint} would be overwritten, since weights are written beside {output}; give "
            "another name with -o."
        )
    output = choose_output(checkpoint, given)
    model = SkinAutoencoder.from_pretrained(checkpoint)
    reports = export_model(model, output, half, describe_checkpoint(checkpoint, output))
    sizes = ", ".join("x".join(map(str, size)) for size in SIZES)
    log(f"compared with torch at {sizes} (batch x height x width)")
    for each in reports:
        _print(each, options.json)


def _print(written: Any, as_json: bool) -> None:
    name, worst = max(written.difference.items(), key=lambda item: item[1])
    if as_json:
        print_line(json.dumps({**asdict(written), "path": str(written.path)}, default=float))
        return
    print_line(
        f"{written.path}: {written.megabytes:.2f} MB, largest difference {worst:.1e} of "
        f"the range ({name}), {written.milliseconds:.0f} ms at 256 x 256"
    )


if __name__ == "__main__":
    sys.exit(main())
