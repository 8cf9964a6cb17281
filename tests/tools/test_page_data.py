"""The page says the sentences of Python, by its limits."""

from tools.page_data import TARGET, make_module


def test_the_page_has_the_data_of_python() -> None:
    remedy = "run python -m tools.page_data"
    assert TARGET.read_text(encoding="utf-8") == make_module(), remedy


def test_sentences_are_whole() -> None:
    module = make_module()
    assert '"{share} of the skin of {who} is overexposed: its colour is lost' in module
    assert "--region" not in module and "--white" not in module
