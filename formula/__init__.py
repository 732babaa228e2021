"""The theta(alpha, openF, P) of a joint: formula, table, look-up and inverse.

Glossary
--------
alpha : angular extent of the uncut sector of the gauze, deg ("alpha_closed")
openF : axial length of the cut, mm
P : gauge pressure, bar
theta : bending angle of the joint, deg

The formula's coefficients are given for degrees, mm and bar, so this package keeps those units
and says them in its names.
"""
