"""Regions of a grid (SPEC 5): boxes of nodes, and how several become one solve."""

import numpy as np


def bounding_box(selected):
    """(i0, i1, j0, j1), ends included, of the selected nodes; None when there are none (SPEC 5)."""
    if not selected.any():
        return None
    i, j = np.nonzero(selected)
    return i.min(), i.max(), j.min(), j.max()


def do_meet(a, b):
    """Whether two boxes share a node."""
    return max(a[0], b[0]) <= min(a[1], b[1]) and max(a[2], b[2]) <= min(a[3], b[3])


def common_box(boxes):
    i0, i1, j0, j1 = zip(*boxes)
    return min(i0), max(i1), min(j0), max(j1)


def islands_of(boxes):
    """Boxes that meet become their common box, until none do."""
    boxes = sorted(set(boxes))
    for box in boxes:
        meeting = [other for other in boxes if do_meet(box, other)]
        if len(meeting) > 1:
            return islands_of([b for b in boxes if b not in meeting] + [common_box(meeting)])
    return boxes


def combined(boxes, how):
    """The regions: each a list of the boxes whose cells it is made of."""
    if not boxes:
        return []
    if how == "box":
        return [[common_box(boxes)]]
    if how == "islands":
        return [[box] for box in islands_of(boxes)]
    with_cells = [box for box in boxes if box[1] > box[0] and box[3] > box[2]]
    return [with_cells] if with_cells else []


def interior_of(region, shape):
    """Nodes all of whose four cells are inside, on the whole grid."""
    cells = np.zeros((shape[0] + 1, shape[1] + 1), dtype=bool)  # cell k ends at node k
    for i0, i1, j0, j1 in region:
        cells[i0 + 1:i1 + 1, j0 + 1:j1 + 1] = True
    return cells[:-1, :-1] & cells[1:, :-1] & cells[:-1, 1:] & cells[1:, 1:]
