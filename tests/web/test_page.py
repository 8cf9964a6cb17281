"""The page reads as Python does, edits in the right direction, and sends nothing away."""

import base64
import io
import json
import re
import struct
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from page_steps import FIRST_MAPS_MS, wait_for_maps
from PIL import Image
from skimage.data import astronaut
from toned_pictures import TONES, make_colour

from skinnet.errors import InputError
from skinnet.images import Box, Face, find_faces
from skinnet.inference import Capture, Decomposer
from skinnet.inference._capture_inputs import make_capture_inputs
from skinnet.inference._doubts import list_doubts
from skinnet.inference._face_checks import check_face
from skinnet.inference._head_crop import crop_head
from skinnet.inference._skin_mask import adopt_mask, find_skin
from skinnet.inference._subject import find_subjects

pytestmark = pytest.mark.slow

MAPS = ("melanin", "hemoglobin", "shading", "specular", "mask", "melanin_sd", "hemoglobin_sd")

Maps = dict[str, NDArray[np.float32]]


@pytest.fixture(scope="module")
def decomposer() -> Decomposer:
    return Decomposer(threads=1)


def read_in_python(
    decomposer: Decomposer,
    photo: NDArray[np.uint8],
    capture: Capture | None = None,
    index: int = 0,
) -> Maps:
    known = {} if capture is None else make_capture_inputs(capture, decomposer.encoder)
    subject = find_subjects(photo, "photo", "all", "face")[index]
    outputs = decomposer._encode(photo, subject, known)
    mask = find_skin(photo, subject, outputs["mask"][0])
    adopted = adopt_mask(outputs, mask, photo[subject.crop.box.slices])
    return {name: each[0] for name, each in adopted.items()}


def download(page: Any, button: str) -> bytes:
    with page.expect_download(timeout=FIRST_MAPS_MS) as waiting:
        page.click(button)
    return Path(waiting.value.path()).read_bytes()


def download_maps(page: Any) -> tuple[Maps, dict[str, Any]]:
    with zipfile.ZipFile(io.BytesIO(download(page, "#save-maps"))) as archive:
        assert archive.testzip() is None
        maps = {name: np.load(io.BytesIO(archive.read(f"{name}.npy"))) for name in MAPS}
        return maps, json.loads(archive.read("summary.json"))


def assert_same(maps: Maps, expected: Maps, share: float = 1.0) -> None:
    """Check that maps are the same, all pixels or a share of them."""
    for name, plane in maps.items():
        assert plane.shape == expected[name].shape, name
        difference = np.abs(plane - expected[name])
        if name in ("mask", "specular"):  # outlines are filled, and edges found, at other sizes
            assert difference.mean() < 3e-3 and np.quantile(difference, 0.99) < 0.05, name
        else:
            assert np.quantile(difference, share) < 1e-3, name


def move_slider(page: Any, name: str, value: float) -> None:
    page.locator(f"#{name}").fill(str(value))


def read_canvas(page: Any) -> NDArray[np.uint8]:
    """The photograph as it is shown, after its edit."""
    page.locator("#photo:not([aria-busy])").wait_for(timeout=FIRST_MAPS_MS)
    address = page.evaluate("document.getElementById('photo').toDataURL()")
    content = base64.b64decode(address.partition(",")[2])
    return np.array(Image.open(io.BytesIO(content)).convert("RGB"))


def test_the_sample_is_read(sample_page: Any) -> None:
    assert re.fullmatch(
        r"Read astronaut\.png: melanin 3\.\d % .*, hemoglobin \d\.\d % .*\.",
        sample_page.inner_text("#status"),
    )
    assert sample_page.locator("#map-grid figure").count() == 6
    assert "Your photo never leaves this page." in sample_page.inner_text("header")


def test_maps_equal_those_of_python(sample_page: Any, decomposer: Decomposer) -> None:
    maps, summary = download_maps(sample_page)
    expected = read_in_python(decomposer, astronaut())
    assert_same(maps, expected)
    low, high = summary["melanin"]["interval"]
    assert low < summary["melanin"]["mean"] < high


@pytest.mark.parametrize(
    ("slider", "value", "is_changed_so"),
    [
        ("melanin", 60, lambda before, after: after.mean() < before.mean() - 5),
        ("melanin", -60, lambda before, after: after.mean() > before.mean() + 3),
        ("hemoglobin", 80, lambda before, after: redness(after) > redness(before) + 0.1),
        ("shine", 300, lambda before, after: after.mean() > before.mean() + 3),
        ("shading", 0, lambda before, after: after.std() < before.std()),
    ],
)
def test_sliders_change_the_skin_in_the_right_direction(
    sample_page: Any,
    slider: str,
    value: int,
    is_changed_so: Callable[[NDArray[np.uint8], NDArray[np.uint8]], bool],
) -> None:
    sample_page.locator("#divider").fill("0")
    before = read_canvas(sample_page)
    move_slider(sample_page, slider, value)
    after = read_canvas(sample_page)
    sample_page.click("#undo")
    np.testing.assert_array_equal(read_canvas(sample_page), before)
    sample_page.locator("#divider").fill("50")
    rows, columns = slice(330, 480), slice(220, 400)  # cheeks and nose
    assert is_changed_so(before[rows, columns], after[rows, columns])
    np.testing.assert_array_equal(after[30:60, :60], before[30:60, :60])  # the wall


def redness(pixels: NDArray[np.uint8]) -> float:
    red, green = pixels.reshape(-1, 3).astype(float).mean(0)[:2]
    return float(red / green)


def test_an_edit_is_where_it_is_painted(sample_page: Any) -> None:
    sample_page.locator("#divider").fill("0")
    sample_page.check("#tools [value=probe]", force=True)
    before = read_canvas(sample_page)
    move_slider(sample_page, "hemoglobin", 100)
    sample_page.check("#tools [value=paint]", force=True)
    box = sample_page.locator("#photo").bounding_box()
    x, y = box["x"] + 0.42 * box["width"], box["y"] + 0.6 * box["height"]  # the right cheek
    sample_page.mouse.move(x, y)
    sample_page.mouse.down()
    sample_page.mouse.move(x + 8, y + 4)
    sample_page.mouse.up()
    sample_page.check("#tools [value=probe]", force=True)
    sample_page.mouse.move(box["x"] + 2, box["y"] + 2)
    after = read_canvas(sample_page)
    for _ in range(2):
        sample_page.click("#undo")
    undone = read_canvas(sample_page)
    sample_page.locator("#divider").fill("50")
    np.testing.assert_array_equal(undone[30:], before[30:])
    changed = (after != before).any(-1)[30:, 30:]
    rows, columns = np.nonzero(changed)
    assert 0.005 < changed.mean() < 0.1
    assert np.ptp(rows) < 200 and np.ptp(columns) < 200


def test_the_edited_photograph_is_that_of_python(sample_page: Any, decomposer: Decomposer) -> None:
    move_slider(sample_page, "melanin", 50)
    content = download(sample_page, "#save-photo")
    sample_page.click("#undo")
    assert_edited_alike(content, astronaut(), decomposer.edit(astronaut(), melanin=5**0.5))


def assert_edited_alike(
    content: bytes, photo: NDArray[np.uint8], expected: NDArray[np.uint8]
) -> None:
    """Check that an edit is that of Python in the photograph's own pixels, to a level of 255."""
    edited = np.array(Image.open(io.BytesIO(content)).convert("RGB"))
    assert edited.shape == photo.shape
    changed = (expected != photo).any(-1)
    difference = np.abs(edited.astype(int) - expected).max(-1)
    assert 0.02 < changed.mean() < 0.1
    assert np.percentile(difference[changed], 98) <= 1 and difference.max() <= 25
    assert ((edited != photo).any(-1) != changed).mean() < 1e-3


def test_a_large_photograph_is_edited_at_its_own_size(
    open_page: Callable[..., Any], decomposer: Decomposer
) -> None:
    size = (1300, 1300)
    photo = np.array(Image.fromarray(astronaut()).resize(size, Image.Resampling.BICUBIC))
    page = open_page()
    open_photo(page, photo)
    wait_for_maps(page)
    move_slider(page, "hemoglobin", 50)
    content = download(page, "#save-photo")
    assert_edited_alike(content, photo, decomposer.edit(photo, hemoglobin=5**0.5))


def test_the_point_is_moved_by_keys(sample_page: Any) -> None:
    sample_page.check("#tools [value=probe]", force=True)
    box = sample_page.locator("#photo").bounding_box()
    sample_page.mouse.move(box["x"] + 0.42 * box["width"], box["y"] + 0.55 * box["height"])
    sample_page.locator("#photo").focus()
    sample_page.keyboard.press("Shift+ArrowDown")
    assert re.match(r"Melanin \d\.\d %, .*; Hemoglobin", sample_page.inner_text("#status"))
    cell = sample_page.locator("#values tbody tr").first.locator("td").nth(1)
    assert re.match(r"\d\.\d %", cell.inner_text())


def test_a_picked_white_is_told_to_the_network(sample_page: Any, decomposer: Decomposer) -> None:
    sample_page.check("#tools [value=white]", force=True)
    box = sample_page.locator("#photo").bounding_box()
    place = (310.5 / 512 * box["width"], 30.5 / 512 * box["height"])
    sample_page.locator("#photo").click(position={"x": place[0], "y": place[1]})
    sample_page.wait_for_selector("#clear-white:visible", timeout=FIRST_MAPS_MS)
    maps, summary = download_maps(sample_page)
    assert "with the white that you picked" in sample_page.inner_text("#status")
    sample_page.click("#clear-white")
    sample_page.wait_for_selector("#clear-white", state="hidden", timeout=FIRST_MAPS_MS)
    capture = Capture.from_reference(astronaut(), (310, 30))
    assert_same(maps, read_in_python(decomposer, astronaut(), capture))
    np.testing.assert_allclose(summary["white_balance"], capture.white_balance, atol=0.02)


def open_photo(page: Any, pixels: NDArray[np.uint8]) -> None:
    content = io.BytesIO()
    Image.fromarray(pixels).save(content, "PNG")
    page.set_input_files(
        "#file", {"name": "photo.png", "mimeType": "image/png", "buffer": content.getvalue()}
    )


def test_a_tilted_head_is_read_as_in_python(
    open_page: Callable[..., Any], decomposer: Decomposer
) -> None:
    turned = np.array(
        Image.fromarray(astronaut()).rotate(-25, Image.Resampling.BICUBIC, expand=True)
    )
    page = open_page()
    open_photo(page, turned)
    wait_for_maps(page)
    maps, summary = download_maps(page)
    assert 20 < summary["tilt"] < 35
    # The tilt differs in its last digits, so that some pixels of the cut do by a level.
    assert_same(maps, read_in_python(decomposer, turned), share=0.97)


def test_each_of_several_faces_is_read_and_edited(
    open_page: Callable[..., Any], decomposer: Decomposer
) -> None:
    head = astronaut()[:260, 90:360]
    pair = np.hstack([head, head[:, ::-1] // 2])
    page = open_page()
    open_photo(page, pair)
    wait_for_maps(page)
    page.locator("#faces option").nth(1).wait_for(state="attached", timeout=FIRST_MAPS_MS)
    for face, pigment in enumerate(("melanin", "hemoglobin")):
        page.select_option("#faces", str(face))
        maps, summary = download_maps(page)
        assert_same(maps, read_in_python(decomposer, pair, index=face), share=0.99)
        assert (summary["box"]["left"] > 200) == bool(face)
        assert page.input_value(f"#{pigment}") == "0"
        move_slider(page, pigment, 80)
    content = download(page, "#save-photo")
    changed = (np.array(Image.open(io.BytesIO(content)).convert("RGB")) != pair).any(-1)
    assert changed[:, :270].mean() > 0.05 and changed[:, 270:].mean() > 0.05


def test_the_camera_takes_a_photograph(open_page: Callable[..., Any]) -> None:
    page = open_page()
    page.click("#use-camera")
    page.wait_for_selector("#camera video:visible")
    while not page.evaluate("document.querySelector('video').videoWidth"):
        page.wait_for_timeout(50)
    page.click("#camera [value=take]")
    said = page.locator("#error").filter(has_text="No face was found in camera.png.")
    said.wait_for(timeout=FIRST_MAPS_MS)  # the false camera shows a test pattern
    assert not page.locator("#camera").is_visible()


def test_a_face_that_is_not_found_is_marked(open_page: Callable[..., Any]) -> None:
    page = open_page(viewport={"width": 1280, "height": 1200})
    suit = np.tile(astronaut()[330:350, 130:150], (16, 16, 1))
    open_photo(page, suit)
    page.wait_for_selector("#error:visible", timeout=FIRST_MAPS_MS)
    assert page.inner_text("#error").startswith("No face was found in photo.png.")
    assert page.is_checked("#tools [value=box]")
    page.locator("#photo").focus()
    page.keyboard.press("Shift+ArrowDown")
    page.keyboard.press("Enter")
    page.wait_for_selector("#maps:visible", timeout=FIRST_MAPS_MS)


def make_huge_png() -> bytes:
    """The beginning of a picture of 60,000 x 60,000 pixels."""
    header = struct.pack(">IIBBBBB", 60_000, 60_000, 8, 2, 0, 0, 0)
    chunk = b"IHDR" + header
    checksum = struct.pack(">I", zlib.crc32(chunk))
    return b"\x89PNG\r\n\x1a\n" + struct.pack(">I", len(header)) + chunk + checksum


def test_what_cannot_be_read_is_a_sentence(open_page: Callable[..., Any]) -> None:
    page = open_page()
    grey = np.repeat(astronaut().mean(-1, keepdims=True), 3, -1).astype(np.uint8)
    content = io.BytesIO()
    Image.fromarray(grey).save(content, "PNG")
    cases = {
        "notes.txt": (b"no picture", "notes.txt is not a picture that this browser can read"),
        "empty.jpg": (b"", "empty.jpg is empty"),
        "huge.png": (make_huge_png(), "huge.png has 60000 \N{MULTIPLICATION SIGN} 60000 pixels"),
        "grey.png": (content.getvalue(), "There is no colour in grey.png: the skin in it is grey."),
    }
    for name, (buffer, sentence) in cases.items():
        page.set_input_files("#file", {"name": name, "mimeType": "image/png", "buffer": buffer})
        page.locator("#error").filter(has_text=sentence).wait_for(timeout=FIRST_MAPS_MS)
        assert page.locator("#error").is_visible()
        assert page.inner_text("#error").endswith(".")


def test_no_request_leaves_the_machine(server: Any, sample_page: Any) -> None:
    download_maps(sample_page)
    addresses = sample_page.requested
    assert f"{server.address}models/skin.onnx" in addresses
    assert all(address.startswith((server.address, "blob:")) for address in addresses)
    refused = sample_page.evaluate(
        """async () => {
            const violation = new Promise((resolve) =>
                addEventListener("securitypolicyviolation", (event) =>
                    resolve(event.effectiveDirective)));
            await fetch("https://example.com/", { method: "POST", body: "photo" }).catch(() => {});
            return violation;
        }"""
    )
    assert refused == "connect-src"


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_no_fault(sample_page: Any, scheme: str) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is missing")
    size = sample_page.viewport_size
    sample_page.set_viewport_size({"width": 390, "height": 844})
    sample_page.emulate_media(color_scheme=scheme)
    violations = axe.Axe().run(sample_page).response["violations"]
    width = sample_page.evaluate("document.documentElement.scrollWidth")
    sample_page.set_viewport_size(size)
    assert [(each["id"], each["impact"]) for each in violations] == []
    assert width <= 390


def test_pictures_are_resized_as_by_pillow(open_page: Callable[..., Any]) -> None:
    page = open_page("licences.txt")  # without the networks
    rng = np.random.default_rng(0)
    # Pillow may resize the columns first where the height shrinks far more; heads keep their shape.
    sizes = (31, 40, 17, 23), (100, 64, 16, 11), (9, 11, 30, 27), (90, 80, 13, 12)
    for height, width, new_height, new_width in sizes:
        pixels = rng.integers(0, 256, (height, width, 3), np.uint8)
        resized = page.evaluate(
            """async ([data, width, height, newWidth, newHeight]) => {
                const { resize } = await import("/src/resizing.js");
                const raster = { data: Uint8Array.from(data), width, height, channels: 3 };
                return Array.from(resize(raster, newWidth, newHeight).data);
            }""",
            [pixels.ravel().tolist(), width, height, new_width, new_height],
        )
        expected = Image.fromarray(pixels).resize(
            (new_width, new_height), Image.Resampling.BILINEAR, reducing_gap=3.0
        )
        np.testing.assert_array_equal(np.reshape(resized, (new_height, new_width, 3)), expected)


def list_unreadable() -> dict[str, NDArray[np.uint8]]:
    """The astronaut in colour, without colour, dark, and drawn."""
    colour = make_colour()
    toned = {name: tone(colour) for name, tone in TONES.items()}
    dark = colour // 8
    return toned | {"colour": colour, "dark": dark, "dark sepia": TONES["sepia"](dark)}


def turn(photo: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.array(Image.fromarray(photo).rotate(-25, Image.Resampling.BICUBIC, expand=True))


def check_in_python(photo: NDArray[np.uint8], face: Face) -> list[str]:
    crop = crop_head(face, photo.shape)
    try:
        return list(check_face(photo, crop, face, "The face in a.png", "a.png"))
    except InputError as error:
        return [
            str(error).replace(
                "; --region skin (in Python region='skin') reads it all the same", ""
            )
        ]


def check_in_page(page: Any, photo: NDArray[np.uint8], face: Face) -> list[str]:
    height, width = photo.shape[:2]
    said: list[str] = page.evaluate(
        """async ([content, width, height, face]) => {
            const { checkFace } = await import("/src/face_checks.js");
            const { cropHead } = await import("/src/head_crop.js");
            const data = Uint8Array.from(atob(content), (letter) => letter.charCodeAt(0));
            const photo = { data, width, height, channels: 3 };
            try {
                return checkFace(photo, cropHead(face, photo), face, "the face in a.png", "a.png");
            } catch (error) {
                return [error.message];
            }
        }""",
        [
            base64.b64encode(photo.tobytes()).decode(),
            *(width, height),
            {"box": face.box._asdict(), "tilt": face.tilt},
        ],
    )
    return said


@pytest.mark.parametrize("is_turned", [False, True])
def test_what_has_no_colour_is_refused_in_the_words_of_python(
    open_page: Callable[..., Any], is_turned: bool
) -> None:
    page = open_page("licences.txt")  # without the networks
    (face,) = find_faces(turn(make_colour()) if is_turned else make_colour())
    said = {}
    for name, photo in list_unreadable().items():
        shown = turn(photo) if is_turned else photo
        said[name] = check_in_page(page, shown, face)
        assert said[name] == check_in_python(shown, face), name
    assert said["colour"] == []
    assert sum("no colour in a.png" in "".join(each) for each in said.values()) > 20


def test_a_face_that_is_cut_off_or_small_is_told_as_in_python(
    open_page: Callable[..., Any],
) -> None:
    page = open_page("licences.txt")
    (face,) = find_faces(astronaut())
    for part, scale in ((slice(190, 512), 1), (slice(235, 512), 1), (slice(0, 512), 5)):
        photo = np.ascontiguousarray(astronaut()[::scale, part][:, ::scale])
        ends = np.array(face.box) - [part.start, 0, part.start, 0]
        moved = replace(face, box=Box(*(ends // scale).tolist()))
        assert check_in_page(page, photo, moved) == check_in_python(photo, moved) != []


@pytest.mark.parametrize("share", [0.0, 0.003, 0.07, 0.3])
@pytest.mark.parametrize(
    ("melanin", "face_sd", "balance", "is_known", "colour"),
    [
        (0.05, (0.2, 0.3), (0.1, -0.3), False, (0.7, -0.3)),
        (0.05, (0.7, 0.3), (0.1, -0.4), False, (0.7, -0.3)),
        (0.05, (0.2, 0.3), (0.1, -0.4), False, (0.1, 0.6)),
        (0.2, (1.2, 1.0), (0.1, 0.1), True, (1.6, -1.2)),
        (0.2, (0.427, 0.6), (0.5, 0.1), False, (1.6, -1.2)),
    ],
)
def test_doubts_are_those_of_python(
    open_page: Callable[..., Any],
    melanin: float,
    face_sd: tuple[float, float],
    balance: tuple[float, float],
    is_known: bool,
    colour: tuple[float, float],
    share: float,
) -> None:
    photo = np.where(np.arange(1000) < 1000 * share * 0.305, 255, 100).astype(np.uint8)
    photo = np.repeat(photo[None, :, None], 3, -1)
    mask = (np.arange(1000)[None] < 1000 * share).astype(np.float32)
    plane = np.full((8, 9), melanin, np.float32)
    outputs = {
        "face_sd": np.array([face_sd], np.float32),
        "white_balance": np.array([balance], np.float32),
        "melanin": plane[None],
        "mask": np.ones((1, 8, 9), np.float32),
    }
    who, known = "the face in a.jpg", ("white_balance",) * is_known
    expected = list(list_doubts(who, photo, mask, outputs, known, colour))
    page = open_page("licences.txt")
    said = page.evaluate(
        """async (values) => {
            const { listDoubts } = await import("/src/uncertainty.js");
            return listDoubts(values);
        }""",
        {
            "who": who,
            "upright": {"melanin": plane.ravel().tolist(), "mask": [1] * plane.size},
            "skinShare": float(np.mean(mask > 0.5)),
            "clipped": float((photo[mask > 0.5] == 255).any(-1).mean()) if share else 0,
            "chromaticity": colour,
            "faceSd": face_sd,
            "whiteBalance": balance,
            "isWhiteKnown": is_known,
        },
    )
    if expected and "--white" in expected[-1]:
        assert "Pick white" in said.pop() and expected.pop()
    assert said == expected


def test_other_faces_and_doubts_are_shown(open_page: Callable[..., Any]) -> None:
    head = astronaut()[:260, 90:360]
    page = open_page()
    open_photo(page, np.hstack([head // 3, head[:, ::-1] // 4]))
    wait_for_maps(page)
    page.locator("#notes").filter(has_text="1 more face was found in photo.png").wait_for(
        timeout=FIRST_MAPS_MS
    )


@pytest.mark.parametrize("way", ["paste", "drop"])
def test_a_photograph_is_pasted_or_dropped(open_page: Callable[..., Any], way: str) -> None:
    content = io.BytesIO()
    Image.fromarray(astronaut()[:260, 90:360]).save(content, "PNG")
    page = open_page()
    page.evaluate(
        """([content, way]) => {
            const bytes = Uint8Array.from(atob(content), (letter) => letter.charCodeAt(0));
            const dataTransfer = new DataTransfer();
            dataTransfer.items.add(new File([bytes], "given.png", { type: "image/png" }));
            const event = way === "paste"
                ? new ClipboardEvent("paste", { clipboardData: dataTransfer, bubbles: true })
                : new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true });
            document.body.dispatchEvent(event);
        }""",
        [base64.b64encode(content.getvalue()).decode(), way],
    )
    wait_for_maps(page)
    assert "given.png" in page.inner_text("#status")
    assert page.locator("#drop").is_hidden()


def press_tab_until(page: Any, selector: str) -> None:
    """Move the focus by the keyboard alone."""
    for _ in range(40):
        page.keyboard.press("Tab")
        if page.evaluate("(selector) => document.activeElement.matches(selector)", selector):
            outline = "getComputedStyle(document.activeElement).outlineStyle"
            assert page.evaluate(outline) != "none", selector
            return
    raise AssertionError(f"{selector} is not reached by Tab")


def test_all_is_done_by_the_keyboard_alone(open_page: Callable[..., Any]) -> None:
    page = open_page()
    press_tab_until(page, "#sample")
    page.keyboard.press("Enter")
    wait_for_maps(page)
    press_tab_until(page, "#tools input")
    page.keyboard.press("ArrowRight")
    assert page.is_checked("#tools [value=paint]")
    press_tab_until(page, "#photo")
    before = read_canvas(page)
    press_tab_until(page, "#hemoglobin")
    for _ in range(5):
        page.keyboard.press("PageUp")
    assert float(page.input_value("#hemoglobin")) > 0
    page.keyboard.press("Shift+Tab")
    press_tab_until(page, "#hemoglobin")
    assert (read_canvas(page) != before).any()
    while page.is_enabled("#undo"):
        page.keyboard.press("Control+z")
    assert page.input_value("#hemoglobin") == "0"
    press_tab_until(page, "#save-photo")
    with page.expect_download(timeout=FIRST_MAPS_MS) as waiting:
        page.keyboard.press("Enter")
    assert waiting.value.suggested_filename == "astronaut_edited.png"
    press_tab_until(page, "#save-maps")


def test_the_divider_shows_before_and_after(sample_page: Any) -> None:
    move_slider(sample_page, "melanin", 80)
    shown = {}
    for share in ("0", "50", "100"):
        sample_page.locator("#divider").fill(share)
        shown[share] = read_canvas(sample_page)
    sample_page.click("#undo")
    middle = shown["0"].shape[1] // 2
    left, right = np.s_[:, : middle - 2], np.s_[:, middle + 2 :]
    np.testing.assert_array_equal(shown["50"][left], shown["100"][left])
    np.testing.assert_array_equal(shown["50"][right], shown["0"][right])
    assert (shown["100"] != shown["0"]).any()
    sample_page.locator("#divider").fill("50")


def test_every_map_has_a_scale_in_percent(sample_page: Any) -> None:
    texts = sample_page.locator("#map-grid figure").all_inner_texts()
    names = "Melanin", "Hemoglobin", "Uncertainty of melanin", "Uncertainty of hemoglobin"
    for name in (*names, "Shading", "Specular reflection"):
        (text,) = (each for each in texts if each.startswith(f"{name}\n"))
        assert re.search(r"\n0\s.*\d+ %", text, re.DOTALL), name
