#!/bin/sh
# Sourced: from a scene to its portals, the four programs in a row. The script says what a stage is, a function
#   stage PROGRAM ARGUMENT...
# that knows where programs are, what else they are told and where their words go.

# find_cut SCENE STEM: STEM.max and STEM.cut.
find_cut() {
  stage ffgraph "$1" -o "$2.max"
  stage mincut "$2.max" -o "$2.cut"
}
# find_portals SCENE STEM: STEM.max, STEM.cut, STEM.vdb and STEM.portal.glb.
find_portals() {
  find_cut "$1" "$2"
  stage lightgrid "$1" "$2.cut" -o "$2.vdb"
  stage portalfit "$2.vdb" -o "$2.portal.glb"
}
