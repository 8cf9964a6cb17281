from skinnet.images import Box, frame_head

FACE = Box(176, 71, 268, 163)


def test_the_crop_is_square_and_holds_the_head() -> None:
    crop = frame_head(FACE, 512, 512)
    assert crop.width == crop.height == 184
    # Hair starts a fifth of a face above the box, and the chin ends just under it.
    assert crop.top < FACE.top - 0.2 * 92 and crop.bottom > FACE.bottom + 0.1 * 92


def test_the_crop_stays_inside_the_picture() -> None:
    assert frame_head(Box(-3, -2, 90, 91), 100, 80) == Box(0, 0, 100, 80)
