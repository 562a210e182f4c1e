"""The short run of the fuzzing tools; the long one is `./run fuzz`."""

import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "core")]


@pytest.fixture(scope="session")
def tools(provider):
    """The provider, its tools watched for exceptions."""
    import cases

    cases.watch({type(tool) for tool in provider.algorithms()})
    return provider
