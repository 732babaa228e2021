#!/bin/sh
# From a design to a prototype, onto the bench, and back: by commands alone, in some minutes.
# The prototype is a twin: the same design in a softer rubber and a thinner wall, with sectors that
# act wider and a gauge that reads too much. Its pictures are rendered from finite elements.
#
#     sh examples/close_the_loop.sh [FOLDER]
set -e
loop=${1:-loop}
bars=0,0.3,0.6,0.9,1.2
mkdir -p "$loop"

profiletool design samples/bulb.png --out "$loop/design"

python samples/bench.py "$loop/design/design.json" --pressures $bars --width 2000 \
    --rubber 0.9 --wall 0.97 --thread 3 --dead 0.04 --out "$loop/pictures"

profiletool measure "$loop/design" "$loop"/pictures/*.jpg --pressures $bars --mm-per-px 0.124 \
    --out "$loop/measured"
profiletool calibrate "$loop/design" "$loop/measured/angles.csv" --out "$loop/tube.json"

# The pressure for this finger; how far the twin then lies off the profile, at the pressure inside.
profiletool trim "$loop/design" --tube "$loop/tube.json" --json | tee "$loop/trim.json"
set_bar=$(python -c "import json, sys; print(json.load(open(sys.argv[1]))['pressure_bar'] - 0.04)" \
    "$loop/trim.json")
profiletool verify "$loop/design" --tube "$loop/pictures/truth_tube.json" --pressure "$set_bar"

# The next finger, designed for this tube.
profiletool design samples/bulb.png --tube "$loop/tube.json" --out "$loop/again"
profiletool verify "$loop/again" --tube "$loop/pictures/truth_tube.json"
