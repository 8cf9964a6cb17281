import pytest
from small_meshes import dome

from skinnet.errors import InputError
from skinnet.mesh._length_unit import guess_length_unit


@pytest.mark.parametrize(
    ("unit", "millimetres"),
    [("metres", 1000.0), ("centimetres", 10.0), ("millimetres", 1.0), ("micrometres", 0.001)],
)
@pytest.mark.parametrize("height", [110, 180, 580])
def test_the_unit_is_guessed(unit: str, millimetres: float, height: float) -> None:
    mesh = dome(height=height / millimetres)
    guess = guess_length_unit(mesh.vertices, "scan.obj")
    assert guess.millimetres == millimetres
    assert guess.note == f"scan.obj is taken to be in {unit}: it is {height} mm long."


@pytest.mark.parametrize("height", [0.0, 3.0, 7000.0])
def test_a_size_that_is_no_face_is_refused(height: float) -> None:
    with pytest.raises(InputError, match=r"The mesh is .* units long, which is no face"):
        guess_length_unit(dome(height=height).vertices)
