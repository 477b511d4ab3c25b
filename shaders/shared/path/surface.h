// All code on surfaces, for kernels and their scalar build: material at a point, and its
// scattering. Users call the functions of place.h and scatter.h, and surface_stops() and
// coverage_at() of coverage.h.
//
// Include in a scope that has
//   Real, in C++                  float
//   load_face(i) and all others of TABLES_OF_SURFACES [tables.h]
//   bool scene_has_layers         some point is more than diffuse about the geometric normal
//        scene_has_normals        some face has a shading normal of its own, apart from maps
//        scene_has_textures, scene_has_colours, scene_has_coats, scene_has_sheen,
//        scene_has_transmission, scene_has_absorption, scene_has_panes
//        scene_has_coverage, coverage_has_textures
// a GLSL file after its buffers, or the body of a C++ struct.

#include "shaders/shared/path/surface_heads.h"

#include "shaders/shared/path/interface_albedo.h"

#include "shaders/shared/path/sheen.h"

#include "shaders/shared/path/coat.h"

#include "shaders/shared/path/bsdf.h"

#include "shaders/shared/path/coated.h"

#include "shaders/shared/path/material.h"

#include "shaders/shared/path/mapped.h"

#include "shaders/shared/path/maps.h"

#include "shaders/shared/path/place.h"

#include "shaders/shared/path/scatter.h"

#include "shaders/shared/path/scattering.h"

#include "shaders/shared/coverage.h"
