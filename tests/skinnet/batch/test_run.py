"""Every photograph is in the output once, whatever happened before."""

import json
import os
from io import BytesIO
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from batch_files import list_parts, read_rows, write_parquet
from flat_decomposer import SKIN, WALL, save
from PIL import Image

from skinnet.batch._attempts import REASON
from skinnet.batch._output import Output
from skinnet.batch._places import Place, find_place


@pytest.fixture
def photos(tmp_path: Path) -> Path:
    """Five photographs, one of them without a face, one damaged."""
    folder = tmp_path / "photos"
    for number in range(3):
        save(folder / f"{number}.png", (200 + number, *SKIN[1:]))
    save(folder / "3.png", WALL)
    (folder / "4.jpg").write_bytes(b"\xff\xd8\xff damaged")
    return folder


def summarise(folder: Path) -> dict[str, str]:
    return {Path(row["file"]).name: row["status"] for row in read_rows(folder)}


ALL = {f"{n}.png": "read" for n in range(3)} | {"3.png": "no_face", "4.jpg": "failed"}


def test_each_photograph_has_a_row(run, photos, tmp_path) -> None:
    code, out, err = run(photos, tmp_path / "out", "--block", 2, "--json")
    assert code == 2
    assert "No face was found in" in err and "4.jpg" in err and "5 photographs." in err
    assert summarise(tmp_path / "out") == ALL
    counts = json.loads(out)
    assert (counts["read"], counts["no_face"], counts["failed"], counts["rows"]) == (3, 1, 1, 5)
    row = read_rows(tmp_path / "out")[1]
    assert row["maps_melanin_mean"] == 0.201 and row["pigments_hemoglobin_mean"] == 0.1005
    assert row["source"] == (photos / "1.png").as_posix() and row["source_row"] is None
    assert row["source_size"] == (photos / "1.png").stat().st_size
    assert row["model_version"] and row["reason"] is None
    assert len(list_parts(tmp_path / "out")) == 3


def test_a_second_run_reads_only_what_is_new(run, photos, tmp_path) -> None:
    run(photos, tmp_path / "out")
    parts = list_parts(tmp_path / "out")
    code, _, err = run(photos, tmp_path / "out")
    assert code == 2 and "5 are in the output already" in err and "4.jpg" in err
    assert list_parts(tmp_path / "out") == parts
    save(photos / "5.png")
    run(photos, tmp_path / "out")
    assert list_parts(tmp_path / "out").items() > parts.items()
    assert summarise(tmp_path / "out") == ALL | {"5.png": "read"}


def test_a_photograph_that_changed_replaces_its_row(run, photos, tmp_path) -> None:
    run(photos, tmp_path / "out")
    save(photos / "1.png", (90, 70, 60))
    os.utime(photos / "1.png", ns=(0, 1))
    run(photos, tmp_path / "out")
    assert summarise(tmp_path / "out") == ALL
    assert read_rows(tmp_path / "out")[1]["maps_melanin_mean"] == 0.09


def test_failures_are_read_again_if_asked_for(run, photos, tmp_path) -> None:
    run(photos, tmp_path / "out")
    before = (photos / "4.jpg").stat()
    data = BytesIO()
    Image.open(photos / "0.png").save(data, "PNG")
    (photos / "4.jpg").write_bytes(data.getvalue()[: before.st_size])
    os.utime(photos / "4.jpg", ns=(before.st_atime_ns, before.st_mtime_ns))
    code, _, err = run(photos, tmp_path / "out", "--retry-failed")
    assert code == 2 and "3 are in the output already" in err
    assert summarise(tmp_path / "out") == ALL


def test_several_faces_have_a_row_each_and_count_as_one_photograph(run, photos, tmp_path) -> None:
    _, out, _ = run(photos, tmp_path / "out", "--faces", "all", "--json")
    assert json.loads(out)["rows"] == 11
    run(photos, tmp_path / "out", "--faces", "all")
    rows = [row for row in read_rows(tmp_path / "out") if row["file"].endswith("1.png")]
    assert [row["id"] for row in rows] == [1, 2, 3] and len({row["key"] for row in rows}) == 1


def test_maps_are_pictures_with_their_scale(run, photos, tmp_path) -> None:
    run(photos, tmp_path / "out", "--maps")
    row = read_rows(tmp_path / "out")[1]
    picture = Image.open(BytesIO(row["map_melanin"]))
    scale, offset = (float(picture.text[key]) for key in ("scale", "offset"))
    value = picture.getpixel((0, 0)) * scale + offset
    assert picture.size == (32, 16) and value == pytest.approx(0.201, abs=2e-5)
    part = next((tmp_path / "out").glob("*.parquet"))
    assert pq.ParquetFile(part).metadata.row_group(0).num_rows == 1


def test_pictures_in_parquet_keep_their_names(run, photos, tmp_path) -> None:
    data = [(photos / f"{n}.png").read_bytes() for n in (0, 3, 1)]
    names = ["a", "b", None, "d"]
    path = write_parquet(tmp_path / "in.parquet", bytes=[*data, None], name=names)
    code, _, err = run(path, tmp_path / "out", "--block", 3)
    rows = {row["source_row"]: row for row in read_rows(tmp_path / "out")}
    assert [rows[n]["status"] for n in range(4)] == ["read", "no_face", "read", "failed"]
    assert rows[0]["file"] == "a" and rows[2]["file"] == f"row 2 of {path}"
    assert code == 2 and "d has no bytes" in err
    assert rows[2]["maps_melanin_mean"] == 0.201


def test_an_object_store_is_read_and_written(run, photos, tmp_path) -> None:
    url = f"memory://batch{tmp_path}"
    for path in photos.iterdir():
        find_place(f"{url}/in").join(path.name).write(path.read_bytes())
    code, _, _ = run(f"{url}/in", f"{url}/out", "--block", 2)
    parts = [place for place, _ in find_place(f"{url}/out").list() if place.name != "_skinnet"]
    rows = [row for part in parts for row in pq.read_table(BytesIO(part.read())).to_pylist()]
    assert code == 2 and {Path(row["file"]).name: row["status"] for row in rows} == ALL
    assert f"{url}/in/1.png" in {row["source"] for row in rows}
    _, _, err = run(f"{url}/in", f"{url}/out", "--block", 2)
    assert "5 are in the output already" in err


def test_a_block_that_was_written_twice_is_there_once(run, photos, tmp_path) -> None:
    run(photos, tmp_path / "out", "--block", 5)
    (part,) = (tmp_path / "out").glob("*.parquet")
    (tmp_path / "out" / f"part-{'0' * 16}.parquet").write_bytes(part.read_bytes())
    save(photos / "5.png")
    run(photos, tmp_path / "out")
    assert len(read_rows(tmp_path / "out")) == 6


def test_what_was_left_unfinished_is_swept(run, photos, tmp_path) -> None:
    run(photos, tmp_path / "out")
    own = tmp_path / "out" / "_skinnet"
    left = [own / "unfinished" / "part-0", own / "plan-1.parquet", own / "run.json-1.part"]
    for path in left:
        path.write_bytes(b"x")
    save(photos / "5.png")
    run(photos, tmp_path / "out")
    assert not any(path.exists() for path in left)
    assert not [path for path in own.rglob("*") if "plan" in path.name]


def test_a_photograph_that_ends_its_worker_twice_is_not_read_a_third_time(
    run, photos, tmp_path, monkeypatch
) -> None:
    import skinnet.batch._worker as worker

    read_rows_, deaths = worker.read_rows, []

    def read_or_die(decomposer, content, *rest):
        if content.photograph.file.endswith("1.png"):
            deaths.append(content.photograph.file)
            raise SystemExit  # as if the process had been killed: nothing catches it
        return read_rows_(decomposer, content, *rest)

    def begin_again(job, count, *_):
        for _ in range(4):
            try:
                yield 0, str(worker.Worker(job)({"block": np.array([0])})["fault"][0])
                return
            except SystemExit:
                continue

    monkeypatch.setattr(worker, "read_rows", read_or_die)
    monkeypatch.setattr("skinnet.batch._run.read_blocks", begin_again)
    assert run(photos, tmp_path / "out", "--block", 5)[0] == 2
    assert len(deaths) == 3  # the first attempt does not record what it reads
    assert summarise(tmp_path / "out") == ALL | {"1.png": "failed"}
    assert read_rows(tmp_path / "out")[1]["reason"] == REASON
    assert not list((tmp_path / "out" / "_skinnet" / "attempts").iterdir())


def test_a_run_that_was_overtaken_writes_nothing_more(run, photos, tmp_path, monkeypatch) -> None:
    check = Output.check_run
    calls = []

    def overtake(self: Output) -> None:
        calls.append(1)
        if len(calls) == 2:  # between reading a block and giving it its name
            (tmp_path / "out" / "_skinnet" / "run.json").write_text('{"run": "other"}')
        check(self)

    monkeypatch.setattr(Output, "check_run", overtake)
    code, _, err = run(photos, tmp_path / "out", "--block", 2)
    assert code == 2 and "Another run writes to" in err
    assert not list_parts(tmp_path / "out")


def test_an_output_that_workers_do_not_see_is_named(run, photos, tmp_path, monkeypatch) -> None:
    seen = str(tmp_path / "out")

    def find(name: str) -> Place:
        return find_place(f"{name}-elsewhere" if name == seen else name)

    monkeypatch.setattr("skinnet.batch._worker.find_place", find)
    code, _, err = run(photos, seen)
    assert code == 2 and "is not seen on every machine" in err
    assert not list_parts(tmp_path / "out")


@pytest.mark.parametrize(
    ("flags", "word"),
    [(("--faces", "all"), "faces"), (("--maps",), "maps"), (("--no-detail",), "detail")],
)
def test_numbers_of_other_settings_are_not_mixed(run, photos, tmp_path, flags, word) -> None:
    run(photos, tmp_path / "out")
    code, _, err = run(photos, tmp_path / "out", *flags)
    assert code == 2 and f"was written with {word}" in err


def test_an_output_with_other_files_is_refused(run, photos, tmp_path) -> None:
    code, _, err = run(photos, photos)
    assert code == 2 and "holds other files, such as 0.png" in err
    code, _, err = run(photos, photos / "0.png")
    assert code == 2 and "is a file; give a folder" in err
    run(photos, tmp_path / "out")
    (tmp_path / "out" / "mine.parquet").write_bytes(b"")
    code, _, err = run(photos, tmp_path / "out")
    assert code == 2 and "such as mine.parquet" in err


def test_a_damaged_part_is_named(run, photos, tmp_path) -> None:
    run(photos, tmp_path / "out", "--block", 5)
    (part,) = (tmp_path / "out").glob("*.parquet")
    part.write_bytes(b"PAR1")
    code, _, err = run(photos, tmp_path / "out")
    assert code == 2 and "is damaged. Remove it, and run again" in err


def test_a_fault_of_skinnet_is_a_row_and_does_not_end_the_run(
    run, photos, tmp_path, monkeypatch
) -> None:
    def fail(*_: object) -> None:
        raise IndexError("list index out of range")

    monkeypatch.setattr("skinnet.batch._rows.check_mark", fail)
    run(photos, tmp_path / "out")
    assert "IndexError" in read_rows(tmp_path / "out")[0]["reason"]
