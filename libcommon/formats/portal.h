// Portal files (.glb/.gltf): planar triangle meshes in metres, counter-clockwise seen from the side
// the light goes to. Written by portalfit or by any modelling program; read by tdpt-render.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libcommon/base/provenance.h"
#include "libcommon/math/vec.h"

namespace tdpt {

struct Portal {
  std::string name;
  std::vector<Vec3d> vertices;                     ///< metres
  std::vector<std::array<uint32_t, 3>> triangles;  ///< into vertices
  std::map<std::string, double> figures;           ///< figures of merit (extras)
  /// The cameras that it serves, by name, with the share of each one's light that crosses it;
  /// empty: all of the file.
  std::map<std::string, double> cameras{};
  /// Light may pass in both directions: some primitive has a doubleSided material.
  bool both_ways = false;
};

/// Sum over all triangles [m2].
double area_of(const Portal& portal);

struct PortalFile {
  std::vector<Portal> portals;  ///< empty: no bottleneck was found
  std::string scene_hash;       ///< of the scene it was made for; empty: modelled by hand
  Provenance provenance;
  std::string hash;                  ///< content hash of the file read
  std::vector<std::string> files{};  ///< paths of buffers read beside it
  /// What the file read has; lamps are punctual lights, luminaires and emissive materials. Portals
  /// need neither.
  size_t cameras = 0, lamps = 0;
  std::vector<std::string> made_for{};  ///< cameras [viewpoint.h]; empty: unknown
};

/// Key in asset.extras of the format's version.
inline constexpr const char* kPortalVersionKey = "tdpt_portal_format";

/// Reads every mesh of the file, one portal per mesh node, with node transforms applied (a
/// mirroring transform keeps the front side). Throws InputError.
PortalFile read_portals(const std::string& path);
/// The file as .glb bytes; portals are named portal.0, portal.1, ...
std::string portal_bytes(const PortalFile& file);

// The figures of portals in words. They are measured with rays and are no promise: only a rendering
// shows what a portal gains for a picture.

/// Above this conductance of the cut, light finds its way without a portal.
inline constexpr double kWide = 0.085;
/// Shares of a portal's lines below this are negligible.
inline constexpr double kNextToNothing = 0.02;

/// What the figures of portal(5) - tightness, conductance - say against a portal: "a
/// wide way, 20 % of the smaller side's light finds it alone"; empty: nothing.
std::string drawback_of(const std::map<std::string, double>& figures);

/// "0.0625 m2, tightness 0.71, conductance 0.0021": the known figures and the
/// drawback. `area`: used if the figures have none [m2].
std::string worth_sentence(const std::map<std::string, double>& figures, double area);

}  // namespace tdpt
