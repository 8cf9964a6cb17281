import pytest

from skinnet.images._xmp import GAIN_MAP, MOTION, find_companions, update_xmp


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (b'<a tiff:Orientation="6" xmp:Rating="6"/>', b'<a tiff:Orientation="1" xmp:Rating="6"/>'),
        (b"<a tiff:Orientation = '8'/>", b"<a tiff:Orientation = '1'/>"),
        (b"<tiff:Orientation>6</tiff:Orientation>", b"<tiff:Orientation>1</tiff:Orientation>"),
        (b'<a exif:PixelXDimension="40"/>', b'<a exif:PixelXDimension="30"/>'),
        (b"<tiff:ImageLength>30</tiff:ImageLength>", b"<tiff:ImageLength>40</tiff:ImageLength>"),
        (b"<a><xmp:Thumbnails><rdf:Alt>x</rdf:Alt></xmp:Thumbnails><b/></a>", b"<a><b/></a>"),
        (b"<a><xap:Thumbnails>x</xap:Thumbnails></a>", b"<a></a>"),
        (b'<a hdrgm:Version="1.0" b="1"/>', b'<a b="1"/>'),
        (b"<a><hdrgm:GainMapMax>2</hdrgm:GainMapMax></a>", b"<a></a>"),
        (b"<a><Container:Directory>x</Container:Directory></a>", b"<a></a>"),
        (b'<a GCamera:MotionPhoto="1" b="1"/>', b'<a b="1"/>'),
        (b"<a crs:Exposure='+0.10'/>", b"<a crs:Exposure='+0.10'/>"),
        (b"", b""),
    ],
)
def test_only_what_an_edit_makes_untrue_changes(before: bytes, after: bytes) -> None:
    assert update_xmp(before, (30, 40)) == after


def test_what_lies_behind_a_picture_is_found() -> None:
    assert find_companions(b'<a hdrgm:Version="1.0"/>') == (GAIN_MAP,)
    assert find_companions(b'<a GCamera:MicroVideoOffset="9"/>') == (MOTION,)
    assert find_companions(b'<a xmp:Rating="1"/>') == ()
