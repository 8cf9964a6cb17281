"""The verbs of the classic pipeline: what each does, and its examples."""

from typing import NamedTuple


class PipelineVerb(NamedTuple):
    """A verb of the classic pipeline.

    Args:
        summary: What it does; a sentence without its end.
        examples: Commands for its help, each with what it does.
    """

    summary: str
    examples: tuple[tuple[str, str], ...]


PIPELINE_VERBS = {
    "fit-shape": PipelineVerb(
        "fit a shape model to scans",
        (
            ("skinnet fit-shape scans/1.obj --shape ICT-FaceKit", "a model of real faces"),
            ("skinnet fit-shape 'scans/*.obj' --config configs/fit-shape.yaml", "the paper's fit"),
            ("skinnet fit-shape scans/1.obj --fit.map-weight 0.5", "a weaker prior"),
        ),
    ),
    "maps": PipelineVerb(
        "make melanin and hemoglobin maps from scans: fit, warp, calibrate, invert",
        (
            ("skinnet maps scans/1.obj scans/2.obj --shape ICT-FaceKit", "maps of two people"),
            ("skinnet maps scans/1.obj --colour.light D65 --warp.size 512", "a known light"),
            ("skinnet maps scans/1.obj --config configs/maps.yaml", "the paper's settings"),
        ),
    ),
    "build-model": PipelineVerb(
        "build a hybrid, a linear and a joint model from the maps of many people",
        (
            ("skinnet build-model skinmaps", "hybrid.npz, linear.npz and their measures"),
            ("skinnet build-model skinmaps --joint --shape ICT-FaceKit", "a joint model too"),
            ("skinnet build-model skinmaps --appearance.components 20", "20 components"),
        ),
    ),
    "sample": PipelineVerb(
        "sample random faces from a model",
        (
            ("skinnet sample skinmodel/hybrid.npz -n 8", "eight random faces"),
            ("skinnet sample skinmodel/hybrid.npz -n 8 --seed 1 --spread 1.5", "more varied ones"),
        ),
    ),
    "edit-maps": PipelineVerb(
        "scale, add to or paint on maps, and render the face again",
        (
            ("skinnet edit-maps skinmaps/1_maps.npz --melanin 1.5", "a tanned face"),
            ("skinnet edit-maps skinmaps/1_maps.npz --hemoglobin-add 0.02 --mask red.png", "blush"),
            ("skinnet edit-maps skinmaps/1_maps.npz --relight.yaw 30", "from its left"),
        ),
    ),
    "export-face": PipelineVerb(
        "write a fitted face as glTF or USD, with its maps as textures",
        (
            ("skinnet export-face skinmaps/1_maps.npz", "skinmaps/1_head.glb, for Blender"),
            ("skinnet export-face skinmaps/1_maps.npz --format usdz", "the same as USD"),
        ),
    ),
}
"""The verbs, in the order in which the help lists them."""
