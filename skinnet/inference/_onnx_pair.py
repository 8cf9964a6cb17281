"""An encoder and a decoder belong together if one export wrote both."""

from skinnet.errors import InputError
from skinnet.inference.onnx_model import OnnxModel


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
    text = str(value)
    return f'"{text}"' if len(text) <= 80 else f'"{text[:60]} ... {text[-20:]}"'
