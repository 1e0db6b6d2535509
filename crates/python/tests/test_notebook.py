"""The notebook runs, and its pictures and drawings show themselves. Skipped where nbclient is not installed."""

from __future__ import annotations

import base64
import importlib.util
from pathlib import Path

import pytest

NOTEBOOK = Path(__file__).resolve().parents[3] / "docs" / "first-pictures.ipynb"


@pytest.mark.skipif(
    any(importlib.util.find_spec(name) is None for name in ("nbclient", "ipykernel")),
    reason="nbclient or ipykernel is not installed",
)
def test_the_notebook_runs(tmp_path: Path) -> None:
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(NOTEBOOK, as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "results are not kept in the repository"
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [output["data"] for cell in notebook.cells for output in cell.get("outputs", []) if "data" in output]
    pictures = [base64.b64decode(data["image/png"]) for data in shown if "image/png" in data]
    assert len(pictures) == 2 and all(picture.startswith(b"\x89PNG") and len(picture) > 5000 for picture in pictures)
    assert sum("<svg" in data.get("image/svg+xml", "") for data in shown) == 1
