"""An encoder and a decoder belong together if one export wrote both."""

from pathlib import Path

from skinnet.errors import InputError
from skinnet.inference.onnx_model import OnnxModel


def get_decoder_path(encoder: Path) -> Path:
    """Return the path of the decoder that belongs to an encoder.

    Args:
        encoder: X.onnx.

    Returns:
        X.decoder.onnx in the same folder.

    Example:
        >>> from pathlib import Path
        >>> from skinnet.inference._onnx_pair import get_decoder_path
        >>> get_decoder_path(Path("runs/skin.onnx")).name
        'skin.decoder.onnx'
    """
    return encoder.with_name(f"{encoder.stem}.decoder.onnx")


def refuse_other_export(encoder: OnnxModel, decoder: OnnxModel) -> None:
    """Refuse a decoder whose metadata are not those of its encoder.

    Its colours would be those of other skin, lights or cameras.

    Raises:
        InputError: They differ.
    """
    pairs = {
        "the preset of the skin": (encoder.optics, decoder.optics),
        "the version of skinnet": (encoder.version, decoder.version),
        "the lights": (", ".join(encoder.lights), ", ".join(decoder.lights)),
        "the working size": (encoder.working_size, decoder.working_size),
        "the training data": (encoder.trained_on, decoder.trained_on),
    }
    for what, (first, second) in pairs.items():
        if first != second:
            raise InputError(
                f"{decoder.path} was not exported together with {encoder.path}: {what} of the "
                f"decoder is {_quote(second)}, and of the encoder {_quote(first)}. Copy the "
                "decoder that was written beside the encoder, or export both again."
            )


def _quote(value: object) -> str:
    text = " ".join(str(value).split())
    return f'"{text}"' if len(text) <= 80 else f'"{text[:60]} ... {text[-20:]}"'
