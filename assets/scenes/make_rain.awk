# SPDX-License-Identifier: GPL-3.0-or-later
# Writes the rain of dinosaurs: `count` of them in layers of nine above a bin, each turned by chance.
#   awk -f assets/scenes/make_rain.awk -v count=40 > assets/scenes/dino_rain.toml
function chance() { state = (state * 16807) % 2147483647; return state / 2147483647 }  # Park and Miller
function wall(name, position, axis, angle) {
  printf "\n[[body]]\nkind = \"rigid\"\nname = \"%s\"\nshape = \"plane\"\nposition = %s\n", name, position
  if (angle != 0) printf "rotation = { axis = %s, angle_deg = %d }\n", axis, angle
}
BEGIN {
  state = 20110301; half = 0.42; apart = 0.27
  print "# A rain of " count " dinosaurs into a bin. Made by assets/scenes/make_rain.awk."
  print "#   souple bake --recipe assets/recipes/dino_rain.toml -o build/demo/dino_rain.souple"
  print "#   souple simulate assets/scenes/dino_rain.toml --steps 2000 --threads 2 -o build/demo/dino_rain"
  print "\n[world]\ntime_step_s = 0.01\nfriction = 0.4\ncontact_method = \"exact\"\ncontact_tolerance = 1e-4"
  print "contact_penetration_m = 2e-5   # a fifth of a percent of an edge\ncontact_max_sweeps = 20000"
  wall("floor", "[0, 0, 0]", "", 0)
  wall("left", "[" (-half) ", 0, 0]", "[0, 1, 0]", 90)
  wall("right", "[" half ", 0, 0]", "[0, 1, 0]", -90)
  wall("front", "[0, " (-half) ", 0]", "[1, 0, 0]", -90)
  wall("back", "[0, " half ", 0]", "[1, 0, 0]", 90)
  for (k = 0; k < count; ++k) {
    cell = k % 9; layer = int(k / 9)
    printf "\n[[body]]\nkind = \"soft\"\nname = \"dino%02d\"\n", k + 1
    print "asset = \"../../build/demo/dino_rain.souple\""
    printf "position = [%.3f, %.3f, %.3f]\n", apart * (cell % 3 - 1), apart * (int(cell / 3) - 1), \
           0.2 + apart * layer
    # A turn drawn evenly (Shoemake 1992).
    u = chance(); v = 6.283185307 * chance(); w = 6.283185307 * chance()
    printf "rotation = { quaternion = [%.6f, %.6f, %.6f, %.6f] }\n", sqrt(u) * cos(w), \
           sqrt(1 - u) * sin(v), sqrt(1 - u) * cos(v), sqrt(u) * sin(w)
  }
  print "\n[output]\nframes_every = 4\ncontent = \"surface\"\ncombined = true\nplane_size_m = 0.84"
}
