"""Photographs to pigment maps and back with onnxruntime."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any, Literal, overload

from skinnet.errors import InputError
from skinnet.images.photograph import read_picture
from skinnet.inference._capture_inputs import CaptureLike, join_captures
from skinnet.inference._face_choice import FaceChoice
from skinnet.inference._image_list import (
    ImageLike,
    drop_frames,
    is_many,
    locate_errors,
    name_all,
    name_image,
)
from skinnet.inference._photo_editor import PhotoEditor
from skinnet.inference._references.profile_use import apply_profile
from skinnet.inference._subject import Region, find_subjects
from skinnet.inference.decomposition import Decomposition


class Decomposer(PhotoEditor):
    """Decomposes photographs of faces into melanin, hemoglobin, shading, light and camera.

    The model files are opened once, at the first photograph. A copy in another process opens them
    again, so a decomposer can be pickled. One decomposer serves several threads.

    Args:
        model: An encoder, X.onnx, with its decoder X.decoder.onnx in the same folder; None for the
            one that comes with the package.
        threads: Number of threads of the CPU; None for all cores.
        providers: What runs the networks: an execution provider of onnxruntime by a short name,
            "cuda", "coreml", "directml" or "cpu", or by its own, "CUDAExecutionProvider"; None for
            the CPU. A list that ends in "cpu" falls back to it, with a note, if the others are
            missing; `Decomposition.provider` says what has run. The search for faces is small, and
            stays on the CPU.

    Attributes:
        encoder: The network from photographs to maps, an `OnnxModel`.
        decoder: The skin model from maps to photographs, an `OnnxModel`.

    Raises:
        InputError: An argument is none of those, or the execution provider is not installed.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet.inference import Decomposer
        >>> decomposition = Decomposer()(astronaut())
        >>> skin = decomposition.mask > 0.5
        >>> 0.01 < float(decomposition.melanin[skin].mean()) < 0.1
        True
        >>> mirrored = astronaut()[:, ::-1]
        >>> len(Decomposer(providers=["cuda", "cpu"])([astronaut(), mirrored], detail=False))
        2
    """

    @overload
    def __call__(  # type: ignore[overload-overlap]  # a path is also an iterable of letters
        self,
        image: ImageLike,
        whole_image: bool = False,
        name: str | None = None,
        detail: bool = True,
        *,
        faces: None = None,
        region: Region = "face",
        capture: CaptureLike | None = None,
    ) -> Decomposition: ...

    @overload
    def __call__(  # type: ignore[overload-overlap]  # a path is also an iterable of letters
        self,
        image: ImageLike,
        whole_image: bool = False,
        name: str | None = None,
        detail: bool = True,
        *,
        faces: FaceChoice,
        region: Region = "face",
        capture: CaptureLike | None = None,
    ) -> list[Decomposition]: ...

    @overload
    def __call__(
        self,
        image: Iterable[ImageLike],
        whole_image: bool = False,
        name: str | None = None,
        detail: bool = True,
        *,
        faces: None = None,
        region: Region = "face",
        capture: CaptureLike | None = None,
    ) -> list[Decomposition]: ...

    @overload
    def __call__(
        self,
        image: Iterable[ImageLike],
        whole_image: bool = False,
        name: str | None = None,
        detail: bool = True,
        *,
        faces: FaceChoice,
        region: Region = "face",
        capture: CaptureLike | None = None,
    ) -> list[list[Decomposition]]: ...

    def __call__(
        self,
        image: ImageLike | Iterable[ImageLike],
        whole_image: bool = False,
        name: str | None = None,
        detail: bool = True,
        *,
        faces: FaceChoice | None = None,
        region: Region = "face",
        capture: CaptureLike | None = None,
    ) -> Decomposition | list[Decomposition] | list[list[Decomposition]]:
        """Decompose a photograph, or several.

        Args:
            image: A path, the bytes of a file, an open file, a Pillow image, an array [H, W, 3], a
                tensor of torch [3, H, W] or a `Picture`; `skinnet.images.read_picture` says what
                they may be. Or several of them: a list, a generator, an array [N, H, W, 3] or a
                tensor [N, 3, H, W]. All their maps are kept at once; `stream` does not.
            whole_image: Another word for `region="skin"`.
            name: Name of the image in error messages; the path by default. Of several, the third
                is name[2], or images[2].
            detail: Whether to add the photograph's detail to the maps; without it they are the
                network's maps, enlarged, which is faster.
            faces: "all", "largest", or how many of the largest faces to read; None for the largest
                one alone.
            region: "face", or "skin" to read whatever skin the photograph shows, such as a forearm,
                without a search for a face.
            capture: What is known of the light and the camera: a `Capture`, or a `CaptureProfile`
                of the session, whose tone curve is undone; None: nothing. Of a RAW file it is
                known, too, that it is linear, and which camera took it if that is a measured one.

        Returns:
            Maps of the photograph's size, light and camera. If `faces` is given, a list of them,
            one for each face, from left to right. Of several images, a list of these, in order.

        Raises:
            InputError: An argument, the image or a model file cannot be used; the image has no
                colour: it is grey, or toned in sepia, cyanotype and the like; the face is too
                small, mostly outside the image, or drawn; or no skin was found. Of several images,
                the first that cannot be read raises it, named; `stream` can go on instead.
            NoFaceError: No face was found.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet.inference import Decomposer
            >>> [each.face_id for each in Decomposer()(astronaut(), faces="all")]
            [1]
        """
        region = "skin" if whole_image else region
        given: Any = image
        if is_many(given):
            options = {"faces": faces, "region": region, "capture": capture}
            return list(self._stream(given, name, detail, options))
        applied = apply_profile(read_picture(given, name), capture)
        picture, capture = applied.picture, applied.capture
        name = name_image(given, name) or "the image"
        known, notes = join_captures(picture, capture, self.encoder)
        picture = replace(picture, notes=(*picture.notes, *notes))
        subjects = find_subjects(picture.srgb, name, faces, region)
        subjects = [self._doubt_white(applied, each, name, known) for each in subjects]
        read = [self._decompose(picture, subject, name, detail, known) for subject in subjects]
        read = [applied.restore(each) for each in read]
        return read[0] if faces is None else read

    @overload
    def stream(
        self,
        images: Iterable[ImageLike],
        *,
        name: str | None = None,
        detail: bool = True,
        faces: None = None,
        region: Region = "face",
        capture: CaptureLike | None = None,
        errors: Literal["raise"] = "raise",
    ) -> Iterator[Decomposition]: ...

    @overload
    def stream(
        self,
        images: Iterable[ImageLike],
        *,
        name: str | None = None,
        detail: bool = True,
        faces: FaceChoice,
        region: Region = "face",
        capture: CaptureLike | None = None,
        errors: Literal["raise"] = "raise",
    ) -> Iterator[list[Decomposition]]: ...

    @overload
    def stream(
        self,
        images: Iterable[ImageLike],
        *,
        name: str | None = None,
        detail: bool = True,
        faces: None = None,
        region: Region = "face",
        capture: CaptureLike | None = None,
        errors: Literal["return"],
    ) -> Iterator[Decomposition | InputError]: ...

    @overload
    def stream(
        self,
        images: Iterable[ImageLike],
        *,
        name: str | None = None,
        detail: bool = True,
        faces: FaceChoice,
        region: Region = "face",
        capture: CaptureLike | None = None,
        errors: Literal["return"],
    ) -> Iterator[list[Decomposition] | InputError]: ...

    def stream(
        self,
        images: Iterable[ImageLike],
        *,
        name: str | None = None,
        detail: bool = True,
        faces: FaceChoice | None = None,
        region: Region = "face",
        capture: CaptureLike | None = None,
        errors: Literal["raise", "return"] = "raise",
    ) -> Iterator[Any]:
        """Decompose many photographs one by one, so that one at a time is in memory.

        Args:
            images: Photographs, as for a call.
            name: What messages call them: the third is name[2], or images[2]; paths are called by
                themselves.
            detail: As for a call.
            faces: As for a call.
            region: As for a call.
            capture: What is known of the light and the camera of all of them, as for a call.
            errors: "raise" ends at the first photograph that cannot be read; "return" yields its
                `InputError` in its place, and goes on.

        Yields:
            What a call gives for each photograph, in order.

        Raises:
            InputError: An argument cannot be used; or a photograph, unless errors are returned.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet import Decomposer, InputError
            >>> photos = [astronaut(), "absent.jpg"]
            >>> read = Decomposer(threads=1).stream(photos, detail=False, errors="return")
            >>> [isinstance(each, InputError) for each in read]
            [False, True]
        """
        if errors not in ("raise", "return"):
            raise InputError(f"errors is raise or return; got {errors!r:.60}.")
        if not is_many(images):
            raise InputError(
                f"stream takes many images, such as a list; got a {type(images).__name__}. Call "
                "the decomposer itself for one image."
            )
        options = {"faces": faces, "region": region, "capture": capture}
        return self._stream(images, name, detail, options, errors == "return")

    def _stream(
        self,
        images: Any,
        name: str | None,
        detail: bool,
        options: dict[str, Any],
        returns_errors: bool = False,
    ) -> Iterator[Any]:
        for image, called, place in name_all(images, name):
            try:
                with locate_errors(image, called, place):
                    read = self(image, False, called, detail, **options)
            except InputError as error:
                if not returns_errors:
                    raise
                yield drop_frames(error)
            else:
                yield read
