"""Takes an edge of a sheet apart.

The edge gets a twin for the element on its other side, and both become part of the rim, where
nothing bends. Then, at each of its ends, the elements around the vertex form a fan that hangs
together over the edges between them; where the cut has split it, each further part of the fan gets
a vertex of its own. So a first cut edge inside the sheet opens nothing, the second opens the vertex
between them, and one that ends in the rim splits the rim.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.tasks.gauze_cutting.cutting.sheet import NONE, Sheet, SparesExhausted

_MOST_DOUBLED = 2
"""vertices that one cut edge may double: its ends"""


@dataclass(frozen=True)
class Doubled:
    """A vertex that has become two."""

    vertex: int
    copy: int


def edge_between(sheet: Sheet, start: int, end: int) -> int | None:
    """The inner edge between two vertices; None where there is none, or only a rim."""
    for edge in np.unique(sheet.element_edges[sheet.elements_at(start)]):
        if set(sheet.edges[edge]) == {start, end} and sheet.flaps[edge, 1] != NONE:
            return int(edge)
    return None


def require_spares(sheet: Sheet) -> None:
    """Raise SparesExhausted where the pool may not do for one more edge."""
    if sheet.spare_edges < 1 or sheet.spare_vertices < _MOST_DOUBLED:
        raise SparesExhausted(
            f"{sheet.spare_edges} spare edges and {sheet.spare_vertices} spare vertices are left; "
            f"wanted 1 and {_MOST_DOUBLED}: compile the sheet with more spare triangles"
        )


def sever(sheet: Sheet, edge: int) -> list[Doubled]:
    """Cut `edge`; the copies lie where their vertices do.

    Raises SparesExhausted before anything has changed, ParameterError for an edge of the rim or
    with an end that is pinned.
    """
    start, end = (int(vertex) for vertex in sheet.edges[edge])
    if sheet.flaps[edge, 1] == NONE or sheet.pinned[[start, end]].any():
        raise ParameterError(f"edge {edge} is on the rim or pinned; wanted an inner, free one")
    require_spares(sheet)
    _open(sheet, edge)
    return [each for vertex in (start, end) for each in _split(sheet, vertex)]


def _open(sheet: Sheet, edge: int) -> None:
    """Give the element on the edge's other side an edge of its own."""
    tip, other_tip = sheet.flaps[edge]
    owners = np.flatnonzero((sheet.element_edges == edge).any(axis=1))
    other = next(one for one in owners if other_tip in sheet.elements[one])
    twin = sheet.take_edge()
    sheet.element_edges[other][sheet.element_edges[other] == edge] = twin
    sheet.point_edge(twin, *sheet.edges[edge])
    sheet.lengths_m[twin] = sheet.lengths_m[edge]
    sheet.flaps[twin] = other_tip, NONE
    sheet.flaps[edge] = tip, NONE
    sheet.bending[[edge, twin]] = 0.0


def _split(sheet: Sheet, vertex: int) -> list[Doubled]:
    """Give each part of the fan around `vertex` but the first a vertex of its own."""
    doubled = []
    for part in _parts(sheet, vertex)[1:]:
        copy = sheet.take_vertex()
        doubled.append(Doubled(vertex, copy))
        sheet.rest_m[copy] = sheet.rest_m[vertex]
        if sheet.texture is not None and sheet.element_texture is not None:
            sheet.texture[copy] = sheet.texture[vertex]
            corners = sheet.element_texture[part]
            sheet.element_texture[part] = np.where(corners == vertex, copy, corners)
        for edge in np.unique(sheet.element_edges[part]):
            if vertex in sheet.edges[edge]:
                ends = (copy if each == vertex else int(each) for each in sheet.edges[edge])
                sheet.point_edge(int(edge), *ends)
        _move_tips(sheet, part, vertex, copy)
        corners = sheet.elements[part]
        sheet.elements[part] = np.where(corners == vertex, copy, corners)
    return doubled


def _move_tips(sheet: Sheet, part: NDArray, vertex: int, copy: int) -> None:
    """Of the edges that face `vertex` in the elements of `part`."""
    facing = sheet.element_edges[part][sheet.elements[part] == vertex]
    for edge in facing:
        # The other tip of such an edge is never the same vertex.
        sheet.flaps[edge][sheet.flaps[edge] == vertex] = copy


def _parts(sheet: Sheet, vertex: int) -> list[NDArray[np.int64]]:
    """The elements around a vertex, by what hangs together over edges that end in it."""
    left = [int(element) for element in sheet.elements_at(vertex)]
    spokes = {
        element: {int(edge) for edge in sheet.element_edges[element] if vertex in sheet.edges[edge]}
        for element in left
    }
    parts = []
    while left:
        part, reached = [left.pop(0)], set()
        reached |= spokes[part[0]]
        while grown := [element for element in left if spokes[element] & reached]:
            for element in grown:
                left.remove(element)
                part.append(element)
                reached |= spokes[element]
        parts.append(np.array(sorted(part)))
    return parts
