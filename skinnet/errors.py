"""Errors whose messages state what the user can do."""

import errno


class InputError(ValueError):
    """An input cannot be used; the message names it, gives its value and states what to do.

    Example:
        >>> from skinnet.images import read_photo
        >>> read_photo("absent.jpg")
        Traceback (most recent call last):
        skinnet.errors.InputError: There is no file absent.jpg; check the path.
    """


class NoFaceError(InputError):
    """No face was found in a photograph."""


_REMEDIES = {
    errno.ENOSPC: "free some space, or {}",
    errno.EDQUOT: "free some space, or {}",
    errno.EROFS: "it cannot be written to: {}",
    errno.ENAMETOOLONG: "give the input a shorter name",
    errno.EMFILE: "close other files, or raise the limit: ulimit -n 4096",
}
"""What to do about an error of the system; else the path is to be checked."""


def _explain_fault(error: OSError, usual: str = "check the path") -> str:
    """Explain an error of the system, in brackets, and what to do about it.

    Args:
        error: The error.
        usual: What to do if the error says nothing better.
    """
    remedy = _REMEDIES.get(error.errno or 0, "{}").format(usual)
    return f"({error.strerror or error}); {remedy}"


def _clip(text: object, longest: int = 60) -> str:
    """What a file or a user has given, as a part of a sentence: one line, and not too long."""
    line = " ".join(str(text).split())
    return line if len(line) <= longest else f"{line[:longest]}..."


def _name_error(error: BaseException) -> str:
    """Name an error, with the start of its message; some repeat the whole input."""
    text = _clip(error, 120)
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def _check_count(name: str, value: int, least: int = 0) -> None:
    """Raise `InputError` unless a setting is a whole number that is not too small."""
    if not value >= least:
        raise InputError(f"{name} is a whole number from {least}; got {value}.")


_TORCH = frozenset({"torch", "jaxtyping", "kornia", "safetensors"})
_SCANS = _TORCH | {"embreex", "h5py", "jsonargparse", "matplotlib", "scipy", "trimesh"}
_EXTRAS = {
    "chart": frozenset({"colour", "colour_checker_detection", "cv2"}),
    "heif": frozenset({"pillow_heif"}),
    "mitsuba": _TORCH | {"mitsuba"},
    "raw": frozenset({"rawpy"}),
    "textures": _TORCH | {"OpenImageIO", "scipy"},
    "video": frozenset({"av"}),
    "torch": _TORCH,
    "scans": _SCANS,
    "train": _SCANS | {"lightning", "rich", "tensorboard", "torchmetrics"},
    "export": _TORCH | {"onnx", "onnxscript"},
    "usd": _SCANS | {"pxr"},
}
"""Top modules that each extra brings, by the names that Python imports."""


def _explain_missing(error: ImportError, extra: str, what: str, install: str = "") -> InputError:
    """Make the error for a module that is not installed.

    The extra is named only if it brings the module: another missing module would still be missing
    after its installation.

    Args:
        error: The error of the import.
        extra: The extra that the command needs.
        what: What needs the module, as the subject of a sentence.
        install: What pip installs for the extra.

    Raises:
        ImportError: `error` itself if it is skinnet that is incomplete.
    """
    module = (error.name or "").partition(".")[0]
    if module in ("skinnet", "train", "export"):
        raise error
    if module in _EXTRAS[extra]:
        command = install or f'"skinnet[{extra}]"'
        return InputError(f"{what} needs the {extra} extra: pip install {command}")
    missing = f"the Python module {module}" if module else "a library that does not load"
    return InputError(
        f"{what} needs {missing} ({error}), which the {extra} extra does not bring; install the "
        "package that has it."
    )
