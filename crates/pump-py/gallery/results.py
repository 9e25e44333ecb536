"""Results as a notebook shows them: a table with a small picture, and `plot()` for a large one.

As a script this draws its pictures and shows none of them.
"""

# %%
import numpy as np

import pumpmodel as pm

pump = pm.Pump.three_roller()
pump

# %% [markdown]
# A plan has the volume with its uncertainty, the pressures, and the flow that the rollers make.

# %%
plan = pm.Doser(pump).plan("10mL", rate="10 mL/s", start_angle_rad=0.3)
plan

# %%
axes = [*plan.plot(), pm.plot_budget(plan)]

# %% [markdown]
# Steady states over the speed: the bands are the ranges of the pressures over a pitch.

# %%
steady = pump.steady_state(speed_rpm=np.arange(5, 171))
steady

# %%
axes = steady.plot()

# %% [markdown]
# Weighed runs make a calibration. The band covers 95 %.

# %%
weights_g = {20: (42.36, 42.33, 42.38), 80: (42.17, 42.20, 42.14), 140: (41.99, 41.95, 42.01)}
runs = [
    pm.WeighedRun(speed_rpm=rpm, turned_deg=720, mass_g=g) for rpm, read in weights_g.items() for g in read
]
calibration = pm.Calibration.from_runs(pump, runs, scale="0.01g")
calibration

# %%
axes = [calibration.plot(pump=pump)]

# %% [markdown]
# The pulsation at the outlet: its harmonics, and how the flow comes to be over one pitch.

# %%
pump.harmonics(10, speed_rpm=100)

# %%
axes = [*pump.harmonics(10, speed_rpm=100).plot(), pm.plot_pitch(pump)]
