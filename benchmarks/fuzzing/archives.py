"""Archives of arrays: maps, models of appearance, fits, readings of photographs."""

import io
import json
import tempfile
import zipfile
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from random import Random

import numpy as np
from skimage.data import astronaut

from benchmarks.fuzzing.case import Case
from benchmarks.fuzzing.changes import change_bytes, change_text, change_value
from benchmarks.fuzzing.small_shapes import make_model
from skinnet.appearance import (
    HybridModel,
    JointModel,
    LinearModel,
    SkinColour,
    SkinTexture,
    load_maps,
    save_maps,
    write_stack,
)
from skinnet.inference import Decomposer, Decomposition
from skinnet.pipeline._fit_archive import load_fit, save_fit
from skinnet.shape import (
    Registration,
    Similarity,
    StageRecord,
    load_shape_model,
    save_shape_model,
)

_DESCR = (
    "'<f4'",
    "'<f8'",
    "'>f4'",
    "'|b1'",
    "'<i8'",
    "'|O'",
    "'<U9'",
    "'<c16'",
    "'|V8'",
    "'<f2'",
    "'|S3'",
    "[('a', '<f4')]",
    "'<M8[s]'",
    "'x'",
    "'<f0'",
    "'<U99999999'",
    "1",
)
_SHAPES = (
    "()",
    "(0,)",
    "(1,)",
    "(-1,)",
    "(3, 3)",
    "(2, 2)",
    "(9999999999,)",
    "(2, -2)",
    "(1e3,)",
    "(4611686018427387904, 4)",
    "(True,)",
    "None",
    "(" * 90 + ")" * 90,
)


def make(rng: Random) -> Case:
    """Make a damaged archive, which is read as what it was."""
    name = rng.choice(list(_READERS))
    data = make_archives()[name]
    if rng.random() < 0.2:
        return _make_damaged(name, data, rng)
    data = change_archive(data, rng)
    return Case(lambda folder: _READERS[name](folder / "a.npz"), {"a.npz": data}, name)


def _make_damaged(name: str, data: bytes, rng: Random) -> Case:
    """Damage of bytes, which is found: the archive has checksums."""
    changed = change_bytes(data, rng)
    if name != "photo":
        return Case(lambda folder: _READERS[name](folder / "a.npz"), {"a.npz": changed}, name)
    return Case(_compare_photos, {"a.npz": changed, "sound.npz": data}, name)


def _compare_photos(folder: Path) -> None:
    found, sound = (Decomposition.load(folder / f"{each}.npz") for each in ("a", "sound"))
    assert np.array_equal(found.melanin, sound.melanin) and found.to_dict() == sound.to_dict()


def change_archive(data: bytes, rng: Random) -> bytes:
    """Change members of an archive of arrays; the archive itself stays sound."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = [(each, archive.read(each)) for each in archive.namelist()]
    for _ in range(rng.choice((1, 1, 2))):
        members = _change_members(members, rng)
    file = io.BytesIO()
    method = rng.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2))
    with zipfile.ZipFile(file, "w", method) as archive:
        for name, content in members:
            archive.writestr(zipfile.ZipInfo(name), content, method)
    return file.getvalue()


def _change_members(members: list[tuple[str, bytes]], rng: Random) -> list[tuple[str, bytes]]:
    at, other = rng.randrange(len(members)), rng.randrange(len(members))
    name, content = members[at]
    rest = members[:at] + members[at + 1 :]
    match rng.randrange(10):
        case 0 if rest:
            return rest
        case 1:
            return [*members, (rng.choice(("x.npy", "x", "", "../x.npy", name + "/")), content)]
        case 2:
            return [*rest, (name, members[other][1])]
        case 3:
            return [*rest, (name, change_bytes(content, rng))]
        case 4:
            return [*rest, (name, bytes(rng.choice((0, 10, 100_000))))]
        case 5:
            return [*rest, (name, _change_header(content, rng))]
        case _:
            return [*rest, (name, _change_array(content, rng))]


def _change_header(content: bytes, rng: Random) -> bytes:
    """Change the header of an array: its type, shape and order, or its text."""
    length = int.from_bytes(content[8:10], "little")
    text = content[10 : 10 + length]
    descr, shape = rng.choice(_DESCR), rng.choice(_SHAPES)
    order = rng.choice(("False", "False", "True", "0", "x"))
    new = f"{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}".encode()
    text = new if rng.random() < 0.7 else change_text(text, rng)
    text = text[:60_000] + b" " * (-(len(text) + 11) % 64) + b"\n"
    return content[:6] + b"\1\0" + len(text).to_bytes(2, "little") + text + content[10 + length :]


def _change_array(content: bytes, rng: Random) -> bytes:
    """Change the values, the type or the shape of an array, or the text in it."""
    try:
        array = np.load(io.BytesIO(content))
    except (ValueError, EOFError, OSError):
        return change_bytes(content, rng)
    if array.dtype.kind == "U" or (array.dtype == np.uint8 and bytes(array[:1].ravel()) == b"{"):
        array = _change_json(array, rng)
    else:
        array = change_numbers(array, rng)
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def _change_json(array: np.ndarray, rng: Random) -> np.ndarray:
    is_text = array.dtype.kind == "U"
    text = str(array) if is_text else array.tobytes().decode()
    try:
        document = json.loads(text)
    except ValueError:
        return np.array(change_text(text.encode(), rng).decode("utf-8", "replace"))
    for _ in range(rng.choice((1, 1, 2))):
        document = change_value(document, rng)
    changed = json.dumps(document)
    return np.array(changed) if is_text else np.frombuffer(changed.encode(), np.uint8)


def change_numbers(array: np.ndarray, rng: Random) -> np.ndarray:
    """Change the type, the shape or the values of an array."""
    match rng.randrange(9):
        case 0:
            return array.astype(rng.choice(("f2", "f4", "f8", "i8", "?", "c16", "u1", "U5")))
        case 1:
            return array.ravel()
        case 2:
            return np.asarray(array)[None]
        case 3:
            return array[..., :0] if array.ndim else array
        case 4:
            return array[:1] if array.ndim else array.reshape(1)
        case 5:
            return np.asfortranarray(array.T)
        case 6:
            return np.concatenate([array, array]) if array.ndim else np.stack([array] * 2)
        case _:
            return _set_number(array, rng)


def _set_number(array: np.ndarray, rng: Random) -> np.ndarray:
    changed = array.copy().reshape(-1)
    places = slice(None) if rng.random() < 0.3 else rng.randrange(max(changed.size, 1))
    if changed.size and changed.dtype.kind == "f":
        changed[places] = rng.choice((np.nan, np.inf, -np.inf, 0, -1, 1, 1e30, 1e-30, 1e38))
    elif changed.size and changed.dtype.kind in "iu":
        info = np.iinfo(changed.dtype)
        changed[places] = rng.choice((0, 1, info.max, info.min, len(changed)))
    elif changed.size and changed.dtype.kind == "b":
        changed[places] = rng.random() < 0.5
    return changed.reshape(array.shape)


@cache
def make_archives() -> dict[str, bytes]:
    """A small file of each kind."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        colour = SkinColour(nodes=(8, 8))
        people = {f"p{at}": _make_person(at) for at in range(4)}
        save_maps(folder / "maps.npz", people["p0"], colour)
        subjects = {name: partial(_get, one) for name, one in people.items()}
        stack = write_stack(folder / "stack", subjects, colour, "people")
        for kind in (HybridModel, LinearModel):
            kind.fit(stack).save(folder / f"{kind.__name__}.npz")
        _make_joint().save(folder / "JointModel.npz")
        save_shape_model(folder / "shape.npz", make_model())
        Decomposer(threads=1)(astronaut()[40:200:2, 130:290:2]).save(folder / "photo.npz")
        _write_fit(folder / "fit.npz")
        return {each.stem: each.read_bytes() for each in folder.glob("*.npz")}


def _make_person(seed: int) -> SkinTexture:
    rng, size = np.random.default_rng(seed), 6
    level = rng.uniform(0.02, 0.1, (2, size, size)).astype(np.float32)
    offset = rng.normal(0, 0.01, (size, size, 3)).astype(np.float32)
    return SkinTexture(level[0], level[1], offset, np.ones((size, size), bool))


def _get(texture: SkinTexture) -> SkinTexture:
    return texture


def _make_joint() -> JointModel:
    rng = np.random.default_rng(0)
    return JointModel.fit(rng.normal(size=(5, 3)), rng.normal(size=(5, 2)), np.ones(3))


def _write_fit(path: Path) -> None:
    mean = make_model().mean
    fit = Registration(
        Similarity(np.eye(3), 1.0, np.zeros(3)),
        np.zeros(3),
        mean,
        np.zeros(len(mean)),
        np.ones(len(mean), bool),
        1.0,
        (StageRecord(len(mean), 3, (2.0, 1.0), True),),
    )
    save_fit(path, fit, {})


def _load_maps(path: Path) -> None:
    texture, _ = load_maps(path)
    for values in (texture.f_mel, texture.f_blood):
        assert ((values[texture.mask] >= 0) & (values[texture.mask] <= 1)).all()


def _load_shape(path: Path) -> None:
    model = load_shape_model(path)
    shape = model.reconstruct(np.ones(len(model.variances)))
    assert np.isfinite(shape).all() and model.triangles.max() < len(model.mean)


def _load_hybrid(path: Path) -> None:
    model = HybridModel.load(path)
    assert np.isfinite(model.sample(2, 0)).all()
    model.texture(model.sample(1, 0)[0])


def _load_linear(path: Path) -> None:
    assert np.isfinite(LinearModel.load(path).sample(2, 0)).all()


def _load_joint(path: Path) -> None:
    assert np.isfinite(JointModel.load(path).sample(2, 0)).all()


def _load_photo(path: Path) -> None:
    decomposition = Decomposition.load(path)
    json.dumps(decomposition.to_dict(), allow_nan=False)
    for values in (decomposition.melanin, decomposition.hemoglobin):
        assert np.isfinite(values).all()


def _load_fit(path: Path) -> None:
    fit = load_fit(path)
    arrays = (*fit.pose, fit.alpha, fit.vertices, fit.distances)
    assert all(np.isfinite(each).all() for each in arrays) and np.isfinite(fit.rms)
    assert fit.vertices.shape == (len(fit.kept), 3) and isinstance(fit.converged, bool)


_READERS: dict[str, Callable[[Path], None]] = {
    "maps": _load_maps,
    "shape": _load_shape,
    "HybridModel": _load_hybrid,
    "LinearModel": _load_linear,
    "JointModel": _load_joint,
    "photo": _load_photo,
    "fit": _load_fit,
}
