"""Opens ONNX files, or says what each is instead, which versions are involved, and what to do."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime
from onnxruntime.capi import onnxruntime_pybind11_state as ort_errors

from skinnet.errors import InputError
from skinnet.files._content import describe_content
from skinnet.inference._onnx_header import Header, read_header
from skinnet.inference._providers import (
    CPU,
    DIRECTML,
    Providers,
    choose_providers,
    describe_failed,
)

REMEDY = "give a file made by `python -m export`, or leave --model out"
"""What to do about a file that is not one of skinnet's."""

_COPY = "copy the decoder that was exported with the encoder to this name"

RUNTIME_ERRORS = (
    *(ort_errors.EPFail, ort_errors.Fail, ort_errors.InvalidArgument, ort_errors.InvalidGraph),
    *(ort_errors.InvalidProtobuf, ort_errors.NoSuchFile, ort_errors.NotImplemented),
    *(ort_errors.RuntimeException, RuntimeError, ValueError),
)
"""What onnxruntime raises."""

_RUNTIME = f"onnxruntime {onnxruntime.__version__}"
_UPGRADE = "pip install -U onnxruntime"
_IR_VERSION = re.compile(r"model IR version: (\d+), max supported IR version: (\d+)")
_OPSET = re.compile(
    r"Opset (\d+) is under development.*domain (\S+) is till opset (\d+)", re.DOTALL
)
_OPERATOR = re.compile(
    r"No Op registered for (?P<op>\S+) with domain_version of \d+"
    r"|(?P<named>\S+?)\(-?\d+\) is not a registered function/op"
    r"|Could not find an implementation for (?P<kernel>\w+)\(\d+\)"
    r"|No opset import for domain '(?P<domain>[^']*)'"
)
_EXTERNAL = re.compile(r"[Ee]xternal (?:data|initializer)")
_DOMAINS = ("", "ai.onnx", "ai.onnx.ml", "com.microsoft", "com.microsoft.nchwc")
"""Sets of operators that onnxruntime brings itself."""


def identify(path: Path, kind: str) -> Header:
    """Read the header of an encoder or a decoder.

    Raises:
        InputError: The file is missing, or not a complete ONNX file.
    """
    if path.is_dir():
        raise InputError(f"{path} is a folder; name the {kind} file, X.onnx.")
    if not path.is_file():
        remedy = REMEDY if kind == "encoder" else f"{_COPY}, or {REMEDY}"
        raise InputError(f"There is no {kind} file {path}; {remedy}.")
    try:
        header = read_header(path)
        content = None if header else describe_content(path)
    except OSError as error:
        raise InputError(f"{path} cannot be read ({error.strerror}); check the path.") from error
    if header is None:
        what, remedy = content or ("of another kind", "")
        remedy = f"{remedy}, or {REMEDY}" if remedy else REMEDY
        raise InputError(f"{path} is not a complete ONNX file (it is {what}); {remedy}.")
    if not header.opsets and not header.missing_bytes:
        raise InputError(
            f"{path} is not a complete ONNX file (it names no set of operators); copy or download "
            f"it again, or {REMEDY}."
        )
    if header.missing_bytes:
        raise InputError(
            f"{path} is not a complete ONNX file (it is cut short: of at least "
            f"{path.stat().st_size + header.missing_bytes:,} bytes there are "
            f"{path.stat().st_size:,}); copy or download it again, or {REMEDY}."
        )
    return header


def open_session(
    path: Path, header: Header, threads: int | None, providers: Providers
) -> onnxruntime.InferenceSession:
    """Open a file.

    Raises:
        InputError: The file is newer than onnxruntime, needs another file or is damaged; or the
            execution provider does not start.
    """
    options = _make_options(threads, providers)
    wanted = providers.installed
    try:
        session = onnxruntime.InferenceSession(path, options, wanted, enable_fallback=0)
    except RUNTIME_ERRORS as error:
        if wanted != [CPU]:  # it may be the device or the file that fails; the CPU tells which
            return _open_on_cpu(path, header, threads, providers)
        raise InputError(f"{path} {_explain(str(error), header)}.") from error
    if not providers.may_fall_back and providers.wanted[0] not in session.get_providers():
        raise InputError(describe_failed(providers.wanted[0]))
    return session


def _open_on_cpu(
    path: Path, header: Header, threads: int | None, providers: Providers
) -> onnxruntime.InferenceSession:
    """Open a file on the CPU after a provider has failed, if that was asked for."""
    session = open_session(path, header, threads, choose_providers(None))
    if not providers.may_fall_back:
        raise InputError(describe_failed(providers.wanted[0]))
    return session


def _make_options(threads: int | None, providers: Providers) -> onnxruntime.SessionOptions:
    options = onnxruntime.SessionOptions()
    options.log_severity_level = 4  # errors are raised; onnxruntime need not print them too
    options.enable_mem_pattern = DIRECTML not in providers.wanted  # which it does not support
    if threads is not None:
        options.intra_op_num_threads = threads
    return options


def check_threads(threads: Any) -> int | None:
    """Check a number of threads; None is all cores.

    Raises:
        InputError: It is no whole number, or less than 1.
    """
    if threads is None:
        return None
    is_whole = isinstance(threads, int | np.integer) and not isinstance(threads, bool)
    if not is_whole or threads < 1:
        raise InputError(
            f"threads is a whole number of at least 1, or None for all cores; got {threads!r:.60}."
        )
    return int(threads)


def _explain(message: str, header: Header) -> str:
    """The rest of a sentence that begins with the file."""
    if found := _IR_VERSION.search(message):
        return (
            f"is newer than {_RUNTIME}: it has IR version {found[1]}, and IR versions up to "
            f"{found[2]} are read; {_UPGRADE}"
        )
    if found := _OPSET.search(message):
        return (
            f"is newer than {_RUNTIME}: it has opset {found[1]} of {found[2]}, and opsets up to "
            f"{found[3]} are read; {_UPGRADE}"
        )
    if found := _OPERATOR.search(message):
        return _explain_operator(found, header)
    if _EXTERNAL.search(message):
        return (
            "keeps its weights in another file, which is missing or cut short "
            f"({_shorten(message)}); copy that file too, or {REMEDY}"
        )
    if "PROTOBUF" in message or "No graph was found" in message:
        return f"is not a complete ONNX file (it is damaged); {REMEDY}"
    return (
        f"cannot be opened: it has {name_versions(header)}, and {_RUNTIME} says "
        f'"{_shorten(message)}"; {_UPGRADE}, or {REMEDY}'
    )


def _explain_operator(found: re.Match[str], header: Header) -> str:
    named = found["named"] or ""
    domain = found["domain"] or named.rpartition(":")[0]
    operator = found["op"] or found["kernel"] or named or f"of {domain}"
    if domain not in _DOMAINS:
        return (
            f"uses the operator {operator}, and {domain} is no set of operators that onnxruntime "
            f"brings; {REMEDY}"
        )
    return (
        f"uses the operator {operator}, which {_RUNTIME} does not know; the file has "
        f"{name_versions(header)}. {_UPGRADE}, or {REMEDY}"
    )


def name_versions(header: Header) -> str:
    """Name the versions that a file states, and the program that made it."""
    sets = ", ".join(
        f"opset {number} of {name or 'ai.onnx'}" for name, number in header.opsets.items()
    )
    maker = f", made by {header.producer}" if header.producer else ""
    return f"IR version {header.ir_version} and {sets or 'no opset'}{maker}"


def _shorten(message: str) -> str:
    """The last sentence of a message of onnxruntime, without the places in its source."""
    last = message.strip().splitlines()[-1].removeprefix("[ONNXRuntimeError] : ")
    return last if len(last) <= 200 else f"...{last[-200:]}"
