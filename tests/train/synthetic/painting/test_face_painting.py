"""Paint on the charts of faces."""

from train.synthetic.painting.face_painting import paint_face
from train.synthetic.scene import SceneParameters


def test_paint_covers_shares_of_the_chart(scene: SceneParameters) -> None:
    charts = paint_face(scene.face)
    assert charts.cover.min() >= 0 and charts.cover.max() <= 1
    assert charts.cover_colour.min() >= 0 and charts.oil.min() > 0
