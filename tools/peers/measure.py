"""How a sheet of another engine is timed: the fastest of up to three runs, as Weft's own methods are."""

import json
import time

MOST_RUNS = 3  # of which the fastest counts: others may be using the machine …
ENOUGH = 3  # … but none after so much time, s


def measure(engine, make_sheet, frames, file):
    """Moves a new sheet through all frames and writes where it was, then others; prints a line of JSON.

    `make_sheet` returns what has `advance_frame()`, which is timed, and `positions()`: x y z of all particles by turns,
    y up, the row of pins first, as an array of 32-bit floats.
    """
    fastest, total = float("inf"), 0.0
    for run in range(MOST_RUNS):
        if total > ENOUGH:
            break
        sheet, seconds = make_sheet(), 0.0
        with open(file, "wb") as out:
            for _ in range(frames):
                begin = time.process_time()
                sheet.advance_frame()
                seconds += time.process_time() - begin
                sheet.positions().tofile(out)
        fastest, total = min(fastest, seconds), total + seconds
    print(json.dumps({"engine": engine, "cpu_ms_per_frame": 1000 * fastest / frames}))
