import numpy as np

from skinnet.images import Box
from skinnet.inference._edited import EditedFace
from skinnet.inference._editing import ColourMeans

BOX = Box(1, 2, 3, 4)


def test_colours_are_levels_of_srgb() -> None:
    face = EditedFace(2, BOX, ColourMeans(10.4, np.full(3, 0.2140), np.array([1.0, 0, 0])))
    assert face.to_json() == {
        "id": 2,
        "box": {"left": 1, "top": 2, "right": 3, "bottom": 4},
        "edited_pixels": 10,
        "colour": {"before": [127.5, 127.5, 127.5], "after": [255.0, 0.0, 0.0]},
    }
    assert face.describe("a.jpg") == (
        "10 pixels of face 2 in a.jpg are edited; their mean colour in sRGB is 128,128,128 before "
        "and 255,0,0 after."
    )


def test_no_skin_has_no_colour() -> None:
    face = EditedFace(None, BOX, ColourMeans(0.0, np.full(3, np.nan), np.full(3, np.nan)))
    assert face.to_json()["colour"] == {"before": None, "after": None}
    assert face.describe("a.jpg") == "No pixel of the skin in a.jpg is edited."
