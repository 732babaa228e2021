"""The formula of a joint: its table, the paper's look-up, and the angle wanted inverted."""

from formula import assign, load_formula, make_table, theta_deg

paper = load_formula()
print(f"theta: {theta_deg(paper, 84.0, 10.0, 1.2):.1f} deg")  # alpha deg, openF mm, bar

table = make_table(paper, openF_mm=[6.0, 8.0, 10.0])
found = assign(table, [8.0, 8.0, 6.0], [30.0, 25.0, 20.0])
print(f"{found.pressure_bar:.2f} bar, alpha {found.alpha_closed_deg} deg")
