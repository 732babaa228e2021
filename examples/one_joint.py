"""Finite elements of one joint: its angle against pressure, and what moves it most."""

from math import degrees, radians

from fem import chain, sensitivities, solve

actuator = chain(30.0, F=[30.0], openF=[10.0], alpha=[radians(84.0)])
solution = solve(actuator, [0.04, 0.08, 0.12])
for state in solution.states:
    print(f"{10.0 * state.pressure:.1f} bar: {degrees(state.theta[0]):5.2f} deg")

last = solution.states[-1]
rates = sensitivities(solution.mesh, last.x, last.pressure)
print(f"0.1 bar more: {degrees(0.01 * rates.pressure.theta[0]):+.2f} deg")
print(f"2 mm more cut: {degrees(2.0 * rates.openF[0].theta[0]):+.2f} deg")
