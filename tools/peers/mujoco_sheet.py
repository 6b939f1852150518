#!/usr/bin/env python3
"""The hung sheet of `weft study peers` in MuJoCo: a flex of triangles with an isotropic membrane, no contact.

mujoco_sheet.py SIDE STEPS INTEGRATOR FRAMES FILE

SIDE particles a side of a square metre, STEPS per frame of 1/60 s, MuJoCo's integrator (discrete or Euler). Writes x y z
of all particles by turns as 32-bit floats (frame by frame, y up, the row of pins first) to FILE, and prints one line of
JSON: {"engine": "MuJoCo 4.0.0", "cpu_ms_per_frame": 10.4}.
"""

import json
import sys
import time

import mujoco
import numpy

DENSITY = 0.2  # kg/m²
STIFFNESS = 8000 / 3  # Young's modulus times thickness, N/m: C11 = 3000, C12 = G = 1000
THICKNESS = 1e-3  # m; only its product with Young's modulus matters without bending


def build_model(side, steps, integrator):
    spacing = 1 / (side - 1)
    # A grid lies in x and y, with y running along the columns first: particle i * side + j is at (i, j).
    pins = f"0 {side * (side - 1)}"
    return mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{1 / 60 / steps}" gravity="0 0 -9.81" integrator="{integrator}"><flag contact="disable"/></option>
  <worldbody>
    <flexcomp name="sheet" type="grid" dim="2" count="{side} {side} 1" spacing="{spacing} {spacing} 1"
              mass="{DENSITY}" radius="0.001">
      <elasticity young="{STIFFNESS / THICKNESS}" poisson="0.3333333" thickness="{THICKNESS}" elastic2d="stretch"/>
      <edge equality="false" damping="0"/>
      <contact selfcollide="none"/>
      <pin id="{pins}"/>
    </flexcomp>
  </worldbody>
</mujoco>""")


def main():
    side, steps, integrator, frames = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3], int(sys.argv[4])
    model = build_model(side, steps, integrator)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    seconds = 0.0
    with open(sys.argv[5], "wb") as out:
        for _ in range(frames):
            begin = time.process_time()
            for _ in range(steps):
                mujoco.mj_step(model, data)
            seconds += time.process_time() - begin
            # Columns become rows, the sheet's corner the origin, z up y up.
            x = data.flexvert_xpos.reshape(side, side, 3).transpose(1, 0, 2)
            here = numpy.stack([x[..., 0] + 0.5, x[..., 2], x[..., 1] + 0.5], axis=-1)
            out.write(here.astype("<f4").tobytes())
    print(json.dumps({"engine": "MuJoCo " + mujoco.__version__, "cpu_ms_per_frame": 1000 * seconds / frames}))


main()
