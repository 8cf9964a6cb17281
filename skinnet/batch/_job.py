"""What the workers of a batch are told, in values that travel to other machines."""

import hashlib
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.inference._face_choice import FaceChoice
from skinnet.inference._onnx_pair import get_decoder_path
from skinnet.inference._subject import Region
from skinnet.inference.decomposer import Decomposer
from skinnet.inference.onnx_model import SHIPPED_ENCODER


class Model(NamedTuple):
    """An encoder and its decoder.

    Attributes:
        digest: SHA-256 of both files.
        files: Their contents, which workers on other machines need; None for the shipped model,
            which is installed there.
        version: Version that the encoder states.
        lights: Names of its lights.
    """

    digest: str
    files: tuple[bytes, bytes] | None
    version: str
    lights: tuple[str, ...]


class Reading(NamedTuple):
    """How photographs are read, as for `Decomposer.__call__`."""

    faces: FaceChoice = "largest"
    region: Region = "face"
    detail: bool = True
    maps: bool = False

    def to_settings(self, model: Model) -> dict[str, Any]:
        """What the numbers depend on, for the record in the output."""
        return {
            "model": f"{model.version} ({model.digest[:12]})",
            "faces": self.faces,
            "region": self.region,
            "detail": self.detail,
            "maps": self.maps,
        }


class Job(NamedTuple):
    """What a worker needs to know.

    Attributes:
        output: URL of the output, with its query.
        token: Names the run.
        query: What the URL of the input states of its store.
        bytes_column: Column of bytes of an input in Parquet.
        name_column: Column of names.
        model: The model.
        reading: How photographs are read.
        version: Version of skinnet, which must be that of the workers.
    """

    output: str
    token: str
    query: str
    bytes_column: str
    name_column: str
    model: Model
    reading: Reading
    version: str = __version__


def read_model(path: Path | None) -> Model:
    """Read a model's files, and check that they can be used.

    Raises:
        InputError: They cannot.
    """
    decomposer = _open(path)
    files = _read_files(decomposer.path)
    encoder = decomposer.encoder
    shipped = None if path is None else files
    return Model(_digest(files), shipped, str(encoder.version), tuple(encoder.lights))


def make_decomposer(job: Job) -> Decomposer:
    """Make the decomposer of a worker.

    Raises:
        InputError: Another skinnet, or another model, is installed here.
    """
    if job.version != __version__ or (
        job.model.files is None and _digest(_read_files(SHIPPED_ENCODER)) != job.model.digest
    ):
        raise InputError(
            f"A machine of the cluster has skinnet {__version__} with another model, and the "
            f"command runs skinnet {job.version}; install the same on all."
        )
    if job.model.files is None:
        return _open(None)
    with TemporaryDirectory(prefix="skinnet-") as folder:
        path = Path(folder) / "encoder.onnx"
        path.write_bytes(job.model.files[0])
        get_decoder_path(path).write_bytes(job.model.files[1])
        return _open(path)


def _open(path: Path | None) -> Decomposer:
    decomposer = Decomposer(path, threads=1)
    decomposer.load()
    return decomposer


def _read_files(encoder: Path) -> tuple[bytes, bytes]:
    return encoder.read_bytes(), get_decoder_path(encoder).read_bytes()


def _digest(files: tuple[bytes, bytes]) -> str:
    return hashlib.sha256(b"".join(files)).hexdigest()
