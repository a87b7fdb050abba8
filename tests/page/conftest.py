"""The page of a small study."""

import pytest
from small_study import make_page


@pytest.fixture(scope="session")
def whole_page(small_project, made_once):
    """Path of its page, beside its results."""
    path = small_project / "results" / "report" / "index.html"

    def make(_):
        with pytest.MonkeyPatch.context() as patch:
            patch.chdir(small_project)
            make_page(path)

    made_once("small_page", make)
    return path
