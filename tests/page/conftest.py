"""The page of a small study, for all tests of pages."""

import pytest
from small_study import make_page


@pytest.fixture(scope="session")
def whole_page(small_project, made_once):
    """Returns the path of the page of the small study, where the workflow writes it."""
    path = small_project / "results" / "report" / "index.html"

    def write_page(_folder):
        with pytest.MonkeyPatch.context() as patch:
            patch.chdir(small_project)
            make_page(path)

    made_once("small_page", write_page)
    return path
