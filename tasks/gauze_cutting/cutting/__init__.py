"""Cutting a MuJoCo flex while it is simulated: a component of its own, for any task.

A two-dimensional flex is read from `mjModel` at every step, its elements and edges included. So a
cut is an edit of the model: `sheet` holds the arrays that such an edit touches, and a pool of
vertices and edges that were compiled along unused; `severing` takes an edge apart and doubles the
vertices whose fan of elements has come apart; `snapping` moves a vertex in material coordinates
onto the blade's path, so that the cut is as smooth as the path and not as the mesh; `crack` follows
a blade's trail with both; `locating` finds the blade in material coordinates; `pieces` tells what
has come free. `journal` applies a cut to a simulation and again to a restored one.

Material coordinates are those of the flat, unstretched sheet, in metres.
"""
