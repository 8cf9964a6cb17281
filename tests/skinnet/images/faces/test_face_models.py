from skinnet.images.faces._face_models import open_ahead, open_face_model


def test_a_network_that_opens_in_the_background_is_opened_once() -> None:
    open_ahead()
    first = open_face_model("face_mesh")
    open_ahead()
    assert open_face_model("face_mesh") is first
