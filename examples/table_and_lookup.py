"""The formula of a joint: its table, the paper's look-up, and its inverse."""

from formula import alpha_deg, assign, load_formula, make_table, theta_deg

paper = load_formula()
theta = theta_deg(paper, 84.0, 10.0, 1.2)
print(f"alpha 84 deg, openF 10 mm, 1.2 bar: theta {theta:.1f} deg")
print(f"alpha for 20 deg there: {alpha_deg(paper, 20.0, 10.0, 1.2):.1f} deg")

table = make_table(paper, openF_mm=[6.0, 8.0, 10.0])
found = assign(table, openF_mm=[8.0, 8.0, 6.0], theta_wanted_deg=[30.0, 25.0, 20.0])
print(f"three joints of 30, 25 and 20 deg: {found.pressure_bar:.2f} bar")
for alpha, got in zip(found.alpha_closed_deg, found.theta_deg, strict=True):
    print(f"  alpha {alpha:g} deg gives {got:.1f} deg")
