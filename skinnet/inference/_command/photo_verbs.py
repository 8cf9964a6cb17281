"""The verbs of photographs: what each does, its examples, its flags and its function."""

import argparse
from collections.abc import Callable
from typing import NamedTuple

from skinnet.inference._command import photo_arguments

Examples = tuple[tuple[str, str], ...]
"""Commands, each with what it does."""


class PhotoVerb(NamedTuple):
    """A verb of photographs.

    Args:
        summary: What it does, for the list of verbs; a sentence without its end.
        add: Adds its flags.
        run: Its function, as MODULE:NAME; the module is imported when the verb runs. The function
            takes the parsed options; False means that an input could not be used.
        examples: Commands for its help.
        more: What its help says beyond the summary.
        prepare: A function, as MODULE:NAME, that completes the parsed options before the verb runs,
            by what only a room above this one knows; empty for none.
    """

    summary: str
    add: Callable[[argparse.ArgumentParser], None]
    run: str
    examples: Examples
    more: str = ""
    prepare: str = ""

    @property
    def description(self) -> str:
        """What the help of the verb begins with."""
        return f"{self.summary[0].upper()}{self.summary[1:]}. {self.more}".strip()


_INFERENCE = "skinnet.inference"

PHOTO_VERBS = {
    "predict": PhotoVerb(
        "make maps, a panel and a summary of photographs",
        photo_arguments.add_predict,
        f"{_INFERENCE}._photo_verbs:predict",
        (
            ("skinnet predict photo.jpg", "files in the folder skinmaps beside the photograph"),
            ("skinnet predict photographs -r --csv numbers.csv", "a folder and its subfolders"),
            ("skinnet predict arm.jpg --region skin --light daylight", "skin without a face"),
        ),
    ),
    "edit": PhotoVerb(
        "change the pigments of photographs: --melanin X, --hemoglobin X, --state NAME AMOUNT",
        photo_arguments.add_edit,
        f"{_INFERENCE}._edit_verb:edit",
        (
            ("skinnet edit photo.jpg --melanin 1.5", "tanned, as photo_edited.jpg"),
            ("skinnet edit photo.jpg --state flush 0.7", "flushed cheeks, nose, ears, forehead"),
            ("skinnet edit photo.jpg --hemoglobin 1.8 --mask cheek.png", "where a mask is white"),
            ("skinnet edit photographs -r --melanin 1.5 -o tanned/", "a folder and its subfolders"),
        ),
        prepare="skinnet.appearance._state_option:read_states",
    ),
    "person": PhotoVerb(
        "fuse shots of one person by their uncertainty, and check that they agree",
        photo_arguments.add_person,
        f"{_INFERENCE}._person_verb:person",
        (
            ("skinnet person monday.jpg tuesday.jpg", "two shots of one person"),
            ("skinnet person shots --json", "all shots of a folder, as one line of JSON"),
        ),
        "Two shots or more become one panel and one summary, region by region. One shot that is "
        "plainly unlike the others is left out. The exit code is 2 if not all shots could be used.",
    ),
    "compare": PhotoVerb(
        "find how melanin and hemoglobin of a face differ in two photographs",
        photo_arguments.add_compare,
        f"{_INFERENCE}._compare_verb:compare",
        (
            ("skinnet compare before.jpg after.jpg", "a picture and a summary of the change"),
            ("skinnet compare before.jpg after.jpg --capture studio.yaml", "in a known session"),
        ),
    ),
    "track": PhotoVerb(
        "follow hemoglobin of a face in a video: pulse, flush and blanching",
        photo_arguments.add_track,
        "skinnet.video._track_verb:track",
        (
            ("skinnet track video.mp4", "a table, a summary, a panel and a video of the map"),
            ("skinnet track frames --fps 25", "a folder of frames without time stamps"),
            ("skinnet track --camera 0 --seconds 60", "a minute of the first camera"),
        ),
        "Every frame is compared with a baseline, the first three seconds. Videos need the video "
        "extra. --camera with a number is a device, and with a name the camera that took the "
        "video. It is no medical device.",
    ),
    "capture": PhotoVerb(
        "make a profile of a session from a picture of a colour chart or a white reference",
        photo_arguments.add_capture,
        f"{_INFERENCE}._capture_verb:capture",
        (
            ("skinnet capture chart.jpg -o studio.yaml", "a ColorChecker in the session's light"),
            ("skinnet capture card.jpg --white 512,380 -o studio.yaml", "a white card, by a point"),
        ),
    ),
    "web": PhotoVerb(
        "open a page that reads and edits photographs in the browser",
        photo_arguments.add_web,
        f"{_INFERENCE}._web.web_verb:web",
        (
            ("skinnet web", "open the page in the browser"),
            ("skinnet web --port 0 --no-open", "print its address alone, at any free port"),
        ),
        "It is served to this computer alone: no photograph leaves the page. Ctrl-C ends it.",
    ),
}
"""The verbs, in the order in which the help lists them."""
