"""One small study of the synthetic lightstage, for all examples that need its people."""

from contextlib import redirect_stdout
from io import StringIO

import pytest
from small_lightstage import PEOPLE, TEXELS, Studied, run_quickly

from examples import lightstage
from skinnet.pipeline import relight


@pytest.fixture(scope="session")
def studied(tmp_path_factory: pytest.TempPathFactory) -> Studied:
    """What `python -m examples.lightstage` writes and prints."""
    folder, printed = tmp_path_factory.mktemp("lightstage"), StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(printed):
        patch.setattr(relight, "TILE_SIZE", 48)
        patch.setattr(lightstage, "skinnet", run_quickly)
        arguments = ["-o", str(folder), "--people", PEOPLE, "--texels", TEXELS]
        assert lightstage.main(arguments) == 0
    return Studied(folder, printed.getvalue())
