"""What the package index shows; hatchling calls it with the ``address`` of ``pyproject.toml``.

The index has the README without the files beside it. With the address of the repository its links
lead there, and the index lists it; without one they name the files, which the sources bring.
"""

import re
from pathlib import Path

from hatchling.metadata.plugin.interface import MetadataHookInterface

LINK = re.compile(r"(!?)\[([^]]*)\]\((?![a-z]+:|#)([^)]*)\)")
"""A picture, or not; its words; a file of the repository."""


class IndexPage(MetadataHookInterface):
    """The README and the addresses of the project, for the package index."""

    def update(self, metadata: dict) -> None:
        """Add ``readme`` and ``urls`` to what ``pyproject.toml`` says of the project."""
        address = self.config["address"].rstrip("/")

        def link(match: re.Match) -> str:
            picture, words, file = match.groups()
            if not address:
                return f"*{words}* (`{file}`)" if picture else f"{words} (`{file}`)"
            return f"{picture}[{words}]({address}/{'raw' if picture else 'blob'}/main/{file})"

        page = LINK.sub(link, Path(self.root, "README.md").read_text(encoding="utf-8"))
        metadata["readme"] = {"content-type": "text/markdown", "text": page}
        if address:
            pages = {"Documentation": "docs/index.md", "Changelog": "CHANGELOG.md"}
            addresses = {name: f"{address}/blob/main/{file}" for name, file in pages.items()}
            metadata["urls"] = {"Homepage": address, "Issues": f"{address}/issues", **addresses}
