"""A profile from points of your own: half an ellipse, and what one more joint brings."""

import numpy as np

from profiletool import design

t = np.linspace(0.5 * np.pi, 1.5 * np.pi, 200)
ellipse = np.column_stack([35.0 * np.cos(t), 50.0 * np.sin(t)])  # mm, from the top down

for joints in (4, 5):
    found = design(ellipse, joints=joints, max_pressure_bar=1.6, verify=False).design
    print(
        f"{joints} joints at {found.pressure_bar:.2f} bar: {found.fit.response.rms_mm:.2f} mm RMS"
    )
