"""Every public name has a docstring, and its examples are true."""

from __future__ import annotations

import doctest
import inspect
from collections.abc import Iterator
from pathlib import Path

import pytest
import vitral
import vitral.osmesa
import vitral.ray

PAGE = Path(__file__).resolve().parents[3] / "docs" / "python.md"


def documented() -> Iterator[tuple[str, str | None]]:
    """All public names with their docstrings."""
    yield "vitral", vitral.__doc__
    yield "vitral.osmesa.install", vitral.osmesa.install.__doc__
    yield "vitral.osmesa.folder", vitral.osmesa.folder.__doc__
    yield "vitral.ray.render", vitral.ray.render.__doc__
    for name in vitral.__all__:
        value = getattr(vitral, name)
        if name.startswith("__"):
            continue
        yield name, value.__doc__
        if inspect.isclass(value) and not issubclass(value, Exception):
            for member in vars(value):
                if not member.startswith("_"):
                    yield f"{name}.{member}", getattr(value, member).__doc__


@pytest.mark.parametrize(("name", "text"), [pytest.param(*row, id=row[0]) for row in documented()])
def test_a_docstring_is_there_and_true(name: str, text: str | None) -> None:
    assert text, f"{name} has no docstring"
    if name.startswith("vitral.osmesa") and not (Path(vitral.osmesa.__file__).parent / "lib").exists():
        pytest.skip("the package was built without libOSMesa")
    example = doctest.DocTestParser().get_doctest(text, {}, name, None, None)
    report: list[str] = []
    doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(example, out=report.append)
    assert not report, "".join(report)


def test_the_page_is_true(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    code = []
    inside = False
    for line in PAGE.read_text().splitlines():
        if line.startswith("```"):
            inside = line == "```python"
        elif inside:
            code.append(line)
    exec(compile("\n".join(code), str(PAGE), "exec"), {"__name__": "page"})
