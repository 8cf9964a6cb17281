"""Libraries print nothing of damaged pictures: the sentence is all that is said."""

import io
import logging
import os
import warnings
from contextlib import suppress

import numpy as np
import pytest
import tifffile
from picture_files import make_photo
from PIL import Image

from skinnet.errors import InputError
from skinnet.images import read_picture
from skinnet.images._silence import silence_libraw


def encode(compression: str) -> bytes:
    file = io.BytesIO()
    Image.fromarray(make_photo(40, 40)).save(file, "TIFF", compression=compression)
    return file.getvalue()


def encode_deep() -> bytes:
    file = io.BytesIO()
    deep = make_photo(40, 40).astype(np.uint16) * 257
    tifffile.imwrite(file, deep, photometric="rgb", rowsperstrip=8, metadata=None)
    return file.getvalue()


@pytest.mark.parametrize(
    "content", [encode("tiff_adobe_deflate"), encode("tiff_lzw"), encode_deep()]
)
def test_a_damaged_tiff_is_refused_in_one_sentence(
    content: bytes, capfd: pytest.CaptureFixture[str]
) -> None:
    middle = len(content) // 3
    for damaged in (content[:middle], content[:middle] + b"\xff" * 99 + content[middle + 99 :]):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with suppress(InputError):  # or what is left of it is read
                read_picture(damaged, "a.tif")
    printed = capfd.readouterr()
    assert printed.out == printed.err == ""


def test_a_log_of_the_application_gets_what_is_wrong(caplog: pytest.LogCaptureFixture) -> None:
    with pytest.raises(InputError):
        read_picture(b"", "a.tif")
    logging.getLogger("tifffile").warning("odd")
    assert "odd" in caplog.text


def test_only_lines_of_libraw_are_left_out(capfd: pytest.CaptureFixture[str]) -> None:
    with silence_libraw, silence_libraw:
        os.write(2, b"unknown file: Unexpected end of file\n")
        os.write(2, b"of another thread\n")
    os.write(2, b"later\n")
    assert capfd.readouterr().err == "of another thread\nlater\n"
