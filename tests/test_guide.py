"""What the README and the guide say, works: their code and commands run, and their names exist."""

import re
import shlex
import shutil
import tomllib
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import pytest
from guide_pictures import write_pictures
from pipeline_scans import FAST, write_scan
from skimage.data import astronaut
from small_runs import SMALL
from small_videos import write_video

import train.cli
from skinnet.batch.__main__ import make_parser
from skinnet.cli import main
from skinnet.inference import SHIPPED_ENCODER, open_model
from skinnet.inference._onnx_pair import get_decoder_path
from skinnet.pipeline import relight

ROOT = Path(__file__).parents[1]
README = ROOT / "README.md"
PAGES = [README, *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)
DOWNLOADED = "ICT-FaceKit"
"""A shape model that users download."""

QUICK = {
    "fit-shape": FAST,
    "maps": (*FAST, "--warp.size=48"),
    "build-model": ("--appearance.samples=3",),
    "edit-maps": ("--relight.size=64",),
}
"""Options that make the slower commands quick."""
QUICK_RUNS = {
    "configs/quick.yaml": (*SMALL, "--trainer.max_epochs=1"),
    "configs/portraits.yaml": (
        "--model.widths=[4,8]",
        "--model.weights=null",
        "--trainer.max_steps=2",
        "--trainer.check_val_every_n_epoch=1",
        "--trainer.precision=32-true",
        "--trainer.accelerator=cpu",
        "--trainer.enable_progress_bar=false",
        "--data.init_args.size=16",
        "--data.init_args.batch_size=2",
        "--data.init_args.synthetic.size=16",
        "--data.init_args.synthetic.batch_size=2",
        "--data.init_args.synthetic.val_samples=2",
        "--data.init_args.synthetic.heads=1",
        "--data.init_args.synthetic.val_heads=1",
    ),
}


def blocks(page: Path, language: str) -> list[str]:
    """List the blocks of code of a page."""
    found = BLOCK.findall(page.read_text(encoding="utf-8"))
    return [code for name, code in found if name == language]


def commands(page: Path) -> list[list[str]]:
    """List the commands of a page, in words."""
    lines = [line for block in blocks(page, "sh") for line in block.splitlines()]
    return [shlex.split(line, comments=True) for line in lines if line.strip()]


def name_page(page: Path) -> str:
    """Name a page in the results of pytest."""
    return page.stem


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the pictures that the guide is about."""
    folder = tmp_path_factory.mktemp("guide")
    write_pictures(folder)
    return folder


@pytest.fixture
def inside(pictures: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A copy of that folder of one's own."""
    shutil.copytree(pictures, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)


CODE = [
    pytest.param(code, id=f"{page.stem}-{number}")
    for page in PAGES
    for number, code in enumerate(blocks(page, "python"), start=1)
]


@pytest.mark.parametrize("code", CODE)
@pytest.mark.usefixtures("inside")
def test_code_runs(code: str) -> None:
    assert len(code.splitlines()) <= 10
    exec(code, {})


WITH_COMMANDS = [page for page in PAGES if page != README and commands(page)]


@pytest.mark.slow
@pytest.mark.parametrize("page", WITH_COMMANDS, ids=name_page)
@pytest.mark.usefixtures("inside")
def test_commands_run(page: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(relight, "TILE_SIZE", 48)  # Faces on panels; ray casting takes seconds.
    Path("configs").symlink_to(ROOT / "configs")
    if page.stem == "scans":
        Path("scans").mkdir()
        for number in (1, 2, 3):
            write_scan(Path(f"scans/{number}.obj"), number)
    if page.stem == "video":
        write_video(Path("video.mp4"), [astronaut()[:256, 96:352]] * 8)
    for words in commands(page):
        RUN[words[0]](words[1:])


def test_the_readme_has_no_command_that_the_guide_has_not() -> None:
    known = [words for page in WITH_COMMANDS for words in commands(page)]
    assert len(commands(README)) >= 7
    for words in commands(README):
        assert words in known, words


def run_skinnet(words: list[str]) -> None:
    """Run the command. The photograph shows no chart, and that of a chart shows no face."""
    if words[0] == "web":  # It serves until Ctrl-C; tests/web run it.
        assert set(words[1:]) <= {"--port", "0", "--no-open", "--host", "0.0.0.0"}
        return
    if DOWNLOADED in words:  # The procedural face stands in; it fits these scans.
        place = words.index(DOWNLOADED)
        words = [*words[: place - 1], *words[place + 1 :]]
    expected = 2 if "--chart" in words else 0
    assert main([*words, *QUICK.get(words[0], ())]) == expected, words


def run_python(words: list[str]) -> None:
    """Run training. Export takes a minute, and its own tests run it: the shipped files stand in.

    Examples and tools have tests of their own, with small sizes.
    """
    if words[1].startswith(("examples.", "tools.")):
        assert words[0] == "-m" and find_spec(words[1]) is not None, words
    elif words[:2] == ["-m", "skinnet.batch"]:  # tests/skinnet/batch run it
        make_parser().parse(words[2:])
    elif words[:2] == ["-m", "export"]:
        checkpoint, flag, output = words[2:]
        assert Path(checkpoint).is_file() and flag == "-o"
        shutil.copy(SHIPPED_ENCODER, output)
        shutil.copy(get_decoder_path(SHIPPED_ENCODER), get_decoder_path(Path(output)))
    else:
        config = words[words.index("--config") + 1]
        assert words[:2] == ["-m", "train"]
        assert train.cli.main([*words[2:], *QUICK_RUNS[config]]) == 0


def check_pip(words: list[str]) -> None:
    """Check that what is to be installed is an extra."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = ",".join(re.findall(r"\[(.+)\]", " ".join(words)))
    assert words[0] == "install" and re.search(r"\bskinnet\b|\.", " ".join(words))
    assert set(filter(None, extras.split(","))) <= set(project["optional-dependencies"])


def check_git(words: list[str]) -> None:
    """Check that what is to be cloned is the shape model; tests load nothing."""
    assert words[0] == "clone" and words[1].endswith(f"/{DOWNLOADED}")


def run_within(words: list[str]) -> None:
    """Run the command that another tool starts; an image is built from the Dockerfile."""
    if words[0] == "build":
        assert (ROOT / "Dockerfile").is_file() and words[-1] == "."
        return
    start = len(words) - words[::-1].index("skinnet")
    run_skinnet(words[start:])


def check_make(words: list[str]) -> None:
    """Check that the target exists."""
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert re.search(rf"^{words[0]}:", makefile, re.MULTILINE)


RUN: dict[str, Callable[[list[str]], None]] = {
    "skinnet": run_skinnet,
    "python": run_python,
    "pip": check_pip,
    "git": check_git,
    "make": check_make,
    **dict.fromkeys(("docker", "pipx", "uvx"), run_within),
}


@pytest.mark.parametrize("page", PAGES, ids=name_page)
def test_links_and_names_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for path in re.findall(r"\]\((?!https?:|#)([^)#]+)", text):
        assert (page.parent / path).exists(), path
    for path in re.findall(r"\b(?:configs|examples|tests|tools|demo)/[\w/]+\.\w+", text):
        assert (ROOT / path).is_file(), path
    for name in re.findall(r"python -m ([a-z][\w.]*\w)", text):
        assert find_spec(name) is not None, name


def test_the_readme_is_short() -> None:
    assert len(README.read_text(encoding="utf-8").split()) <= 900


def test_the_readme_compares_as_the_model_card_does() -> None:
    card = ROOT / "skinnet" / "inference" / "models" / "MODEL_CARD.md"
    table = README.read_text(encoding="utf-8").partition("| | melanin | hemoglobin |")[2]
    rows = [read_row(line) for line in table.splitlines()[2:7]]
    assert len(rows) == 5 and all(len(row) == 3 for row in rows)
    assert set(rows) <= {read_row(line) for line in card.read_text(encoding="utf-8").splitlines()}


def read_row(line: str) -> tuple[str, ...]:
    """Read the first number of each cell of a table, the name of the row aside."""
    return tuple(cell.strip().partition(",")[0] for cell in line.split("|")[2:-1])


def test_every_benchmark_is_listed() -> None:
    text = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
    for module in (ROOT / "benchmarks").glob("*.py"):
        runs = "__main__" in module.read_text(encoding="utf-8")
        assert runs == (f"`python -m benchmarks.{module.stem}`" in text), module.stem


@pytest.mark.parametrize("verb", ["predict", "edit", "person", "compare", "capture"])
def test_every_flag_is_explained(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([verb, "--help"]) == 0
    text = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    usage = capsys.readouterr().out.partition("\n\n")[0]
    for flag in re.findall(r"--[a-z][a-z-]+", usage):
        row = re.search(rf"^\| .*`?{flag}\b.*$", text, re.MULTILINE)
        assert row, flag
        verbs = row[0].split(" | ")[1]
        excepted = verbs.startswith("all but") and f"`{verb}`" in verbs
        assert not excepted and ("all" in verbs or f"`{verb}`" in verbs), (flag, verb)


@pytest.mark.filterwarnings("ignore")
def test_the_contract_is_that_of_the_file() -> None:
    session = open_model(SHIPPED_ENCODER, "encoder", threads=1).session
    values = [*session.get_inputs(), *session.get_overridable_initializers()]
    text = (ROOT / "docs" / "files.md").read_text(encoding="utf-8")
    for value in [*values, *session.get_outputs()]:
        shape = ", ".join(str(length) for length in value.shape)
        row = rf"^\| `{value.name}`[^|]*\| `\[{re.escape(shape)}\]`"
        assert re.search(row, text, re.MULTILINE), (value.name, shape)
