"""Contact of an actuator's outer surface with a rigid obstacle that is given by its gap.

A point x of the outer surface has the gap g(x): its distance from the obstacle, negative inside
it. Contact adds the potential sum W eps psi(-g) over Gauss points of the outer faces, W their
area at rest. Taken at nodes, a uniform pressure would pull at the corners of quadratic faces.

Glossary
--------
g, n, H : gap (mm), its gradient (the obstacle's outward normal), its second derivative (1/mm)
eps : penalty, MPa of contact pressure per mm of depth
"""
