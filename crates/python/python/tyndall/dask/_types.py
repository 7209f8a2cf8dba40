"""Dask's clients and futures as types: those of its own differ from version to version, and so nothing here leans on them."""

from __future__ import annotations

from typing import Any, TypeAlias

Client: TypeAlias = Any
Future: TypeAlias = Any
