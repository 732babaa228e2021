"""One joint in three rubbers of the same initial shear modulus: the law matters as it stretches."""

from math import degrees, radians

from fem import PAPER_RUBBER, NeoHooke, Yeoh, chain, solve

half = 0.5 * PAPER_RUBBER.shear_modulus  # MPa
for rubber in (
    PAPER_RUBBER,
    NeoHooke.from_poisson(half, nu=0.46),
    Yeoh.from_poisson(half, 0.02, 0.0, nu=0.46),
):
    actuator = chain(30.0, F=[30.0], openF=[10.0], alpha=[radians(84.0)], rubber=rubber)
    theta = solve(actuator, [0.1]).states[-1].theta[0]
    print(f"{rubber.name}: {degrees(theta):.2f} deg at 1 bar")
