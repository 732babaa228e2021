"""Finite elements of the actuator; numpy and scipy only, no pictures, designs or formulas.

Glossary
--------
X, x : reference and current position, mm
F, J : deformation gradient dx/dX and its determinant
H : cofactor of F, dJ/dF
P : first Piola-Kirchhoff stress dW/dF, MPa (in kernels); the gauge pressure is ``pressure``
W : stored energy per reference volume, MPa
lam : stretch of a thread, current length over length at rest
ring, mid : the nodes of one cross-section between two layers of elements, and half-way in a layer
layer : the elements between two rings
window : the axial stretch of a joint in which the axial threads are cut, but for a sector

Frame: z along the tube from the clamped end, x and y across; an angular position phi is measured
counter-clockwise from +x as seen from the closed end. The object faces phi = 270 deg (-y). A
positive joint angle turns the closed end toward -y. Lengths in mm, stresses in MPa, angles in rad.
"""
