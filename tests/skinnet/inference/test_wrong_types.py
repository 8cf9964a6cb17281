"""Arguments of the wrong type are refused in a sentence by every public name for photographs.

Outside pytest, where types are not checked before a function runs.
"""

import subprocess
import sys
import textwrap
from pathlib import Path

SCRIPT = """
    import io, sys, warnings
    import numpy as np
    from skinnet import Decomposer, Decomposition, InputError
    from skinnet.images import Box, find_faces, read_photo, read_picture, segment_skin
    from skinnet.inference import (
        SHIPPED_ENCODER, Capture, Person, compare_photographs, compute_indices, draw_panel,
        open_model, write_results,
    )

    warnings.simplefilter("ignore")
    decomposer = Decomposer(threads=1)
    photo = np.full((24, 32, 3), (200, 150, 130), np.uint8)
    photo[::2] -= 3
    read = decomposer(photo, region="skin", detail=False)
    read.save(sys.argv[1] + "/a.npz")
    matrix, words = np.zeros((4, 4)).view(np.matrix), "a text"
    odd = (matrix, 1j, object(), [matrix], {"a": 1}, np.array([0.5, 0.6]), np.array("x"))
    numbers = (*odd, words, None, True, [0.5], 10**400)
    cases = {
        "threads": (lambda v: Decomposer(threads=v), (*odd, words, 1.5, True, 2.0, [1])),
        "model": (Decomposer, (*odd, 3, b"x")),
        "providers": (lambda v: Decomposer(providers=v), (*odd, 3, [3], (), b"cuda")),
        "image": (decomposer, (*odd[:4], 3, int, np.array(None), io.StringIO("a"), None)),
        "read_photo": (read_photo, (*odd, 3, io.StringIO("a"), None, [photo])),
        "edit": (decomposer.edit, (matrix, 1j, object(), 3, None)),
        "edit_picture": (decomposer.edit_picture, (*odd, 3, None)),
        "name": (lambda v: decomposer(photo, region="skin", name=v), (*odd, 3)),
        "faces": (lambda v: decomposer(photo, faces=v), (*odd, 1.5, True, words, [1])),
        "region": (lambda v: decomposer(photo, region=v), (*odd, 1, words, None)),
        "capture": (lambda v: decomposer(photo, region="skin", capture=v), (*odd, 1, words)),
        "errors": (lambda v: decomposer.stream([photo], errors=v), (words, None, 1)),
        "melanin": (lambda v: decomposer.edit(photo, v, region="skin"), numbers),
        "hemoglobin": (lambda v: read.edit(hemoglobin=v), numbers),
        "mask": (lambda v: read.edit(2.0, mask=v), (*odd, words, 3)),
        "level": (read.interval, numbers),
        "level of indices": (read.indices, numbers),
        "map": (read.get_map, (*odd, words, None, "light", "offset_x")),
        "described map": (read.describe_map, (*odd, words, None)),
        "region of the face": (read.region_mask, (*odd, words, None)),
        "file": (read.save, (*odd, 3, None, b"a.npz", words)),
        "saved": (Decomposition.load, (*odd, 3, None, b"a.npz", words)),
        "decomposer": (
            lambda v: Decomposition.load(sys.argv[1] + "/a.npz", decomposer=v), (3, words),
        ),
        "fraction": (lambda v: compute_indices(v, 0.1), numbers),
        "log_sds": (lambda v: compute_indices(0.1, 0.1, v), (*odd, words, None, 3, (1, 2, 3))),
        "find_faces": (find_faces, (*odd, words, None, photo / 255, photo[..., 0])),
        "segment_skin": (lambda v: segment_skin(v, Box(0, 0, 9, 9)), (*odd, None, photo / 255)),
        "face": (lambda v: segment_skin(photo, v), (*odd, None, (0, 0, 9, 9))),
        "draw_panel": (lambda v: draw_panel(v, read), (*odd, None, photo / 255, photo[:9])),
        "results": (lambda v: write_results(v, "a", photo, read, {}), (*odd, None, 3)),
        "compared": (
            lambda v: compare_photographs(v, photo, decomposer=decomposer), (*odd, None, 3),
        ),
        "comparer": (lambda v: compare_photographs(photo, photo, decomposer=v), (3, words)),
        "names": (
            lambda v: compare_photographs(photo, photo, decomposer=decomposer, names=v),
            (3, words, ("a", 1)),
        ),
        "shots": (Person.from_shots, (*odd, 3, None, [read, 3], words)),
        "names of shots": (lambda v: Person.from_shots([read, read], v), (3, words, [1, 2])),
        "white": (Capture.from_white, (*odd, None, words, 3, (1, 2))),
        "reflectance": (lambda v: Capture.from_white((200, 200, 200), v), (*odd, words, True)),
        "place": (lambda v: Capture.from_reference(photo, v), (*odd, None, 3, words, (1.5, 2))),
        "colour": (lambda v: Capture.from_reference(photo, (9, 9), v), (*odd, words, (1, 2))),
        "camera": (Capture.from_names, (*odd, 3)),
        "light": (lambda v: Capture.from_names(light=v), (*odd, 3)),
        "opened": (lambda v: open_model(v, "encoder"), (*odd, 3, None, b"x")),
        "kind": (lambda v: open_model(SHIPPED_ENCODER, v), (words,)),
    }
    if "torch" in sys.modules:
        print("torch was imported")
    for name, (call, values) in cases.items():
        for value in values:
            try:
                call(value)
                print(name, repr(value)[:40], "was taken")
            except InputError as error:
                if not str(error).endswith((".", "?", ")")):
                    print(name, repr(value)[:40], "no sentence:", error)
            except Exception as error:
                print(name, repr(value)[:40], type(error).__name__, error)
"""


def test_every_wrong_type_gets_a_sentence(tmp_path: Path) -> None:
    command = [sys.executable, "-c", textwrap.dedent(SCRIPT), str(tmp_path)]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout == ""
