"""`python -m export CHECKPOINT -o skin.onnx`."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from skinnet.errors import InputError, _explain_missing
from skinnet.inference._messages import (
    note_removed,
    open_missing_streams,
    quit_at_interrupt,
    report,
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Export a checkpoint; return 0, or 2 with a sentence on stderr for bad input."""
    open_missing_streams()
    parser = argparse.ArgumentParser(
        prog="python -m export",
        description="Write a checkpoint as ONNX, compared with torch: the encoder to FILE, and "
        "beside it the decoder, .decoder.onnx, and the weights, .safetensors.",
    )
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
    options = parser.parse_args(arguments)
    try:
        _export(options.checkpoint, options.output, options.half)
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


def _export(checkpoint: Path, given: Path | None, half: bool) -> None:
    # Imported here, so that --help does not wait for torch.
    with quit_at_interrupt():
        from export.onnx_file import SIZES, export_model
        from export.outputs import DEFAULT, choose_output, describe_checkpoint
        from skinnet.network import SkinAutoencoder

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
    print(f"compared with torch at {sizes} (batch x height x width)")
    for each in reports:
        name, worst = max(each.difference.items(), key=lambda item: item[1])
        print(
            f"{each.path}: {each.megabytes:.2f} MB, largest difference {worst:.1e} of "
            f"the range ({name}), {each.milliseconds:.0f} ms at 256 x 256"
        )


if __name__ == "__main__":
    sys.exit(main())
