# SPDX-License-Identifier: GPL-3.0-or-later
# Writes a torus about the z axis as OFF: outer diameter 1, radius of its tube `tube`, `around` by
# `across` vertices. The surfaces of this folder came from
#   awk -f assets/surfaces/make_ring.awk -v tube=0.1  -v around=48 -v across=16 > assets/surfaces/link.off
#   awk -f assets/surfaces/make_ring.awk -v tube=0.17 -v around=40 -v across=20 > assets/surfaces/ring.off
BEGIN {
  pi = atan2(0, -1); middle = 0.5 - tube
  print "OFF"
  print around * across, 2 * around * across, 0
  for (i = 0; i < around; ++i)
    for (j = 0; j < across; ++j) {
      a = 2 * pi * i / around; b = 2 * pi * j / across
      r = middle + tube * cos(b)
      printf "%.9f %.9f %.9f\n", r * cos(a), r * sin(a), tube * sin(b)
    }
  for (i = 0; i < around; ++i)
    for (j = 0; j < across; ++j) {
      k = (i + 1) % around; l = (j + 1) % across
      print 3, i * across + j, k * across + j, k * across + l
      print 3, i * across + j, k * across + l, i * across + l
    }
}
