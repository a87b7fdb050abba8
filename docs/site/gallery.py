"""Draw the figures of docs/gallery again: run each page's blocks, keep the figure it shows.

`make gallery`, or `python docs/site/gallery.py PAGE.md ...` for some of them.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
GALLERY = ROOT / "docs" / "gallery"


def main(pages: list[Path]) -> None:
    """Run the pages, each in a folder of its own."""
    environment = os.environ | {
        "MPLBACKEND": "agg",
        "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
    }
    for page in pages:
        text = page.read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            shutil.copytree(ROOT / "config", folder / "config")
            shutil.copytree(GALLERY, folder / "docs" / "gallery")
            for language, block in re.findall(r"^```(\w+)\n(.*?)^```$", text, re.M | re.S):
                start = {"python": [sys.executable, "-c"], "console": None, "text": None}
                argv = start.get(language, ["bash", "-eu", "-c"])
                if argv:
                    subprocess.run([*argv, block], cwd=folder, env=environment, check=True)
            for figure in re.findall(r"!\[[^\]]*\]\(([\w.-]+)\)", text):
                shutil.copy(folder / figure, GALLERY / figure)
                print(f"{GALLERY / figure}: written")


if __name__ == "__main__":
    given = [Path(name).resolve() for name in sys.argv[1:]]
    main(given or sorted(page for page in GALLERY.glob("*.md") if page.name != "index.md"))
