#include "tools/tdpt-render/bench/device_traffic.h"

namespace tdpt {
namespace {

// Records of each kind that one invocation reads, or writes.
struct Records {
  int vertices = 0, densities = 0, rays = 0, connections = 0, scatterings = 0, ends = 0,
      segments = 0, sides = 0, words = 0;
};
struct Touched {
  Records read, written;
};

// In the order of Step. Connections are written by the steps that choose them but counted at `see`,
// which handles each. traffic_of() counts candidate connections.
constexpr std::array<Touched, static_cast<size_t>(Step::kSteps)> kTouched{{
    {{}, {.vertices = 1, .densities = 1, .rays = 1, .words = 1}},  // begin light
    {{}, {.rays = 1, .words = 1}},                                 // begin camera
    {{.vertices = 1, .densities = 1, .words = 1}, {.rays = 1}},    // go on, light
    {{.vertices = 1, .densities = 1, .words = 1}, {.rays = 1}},    // go on, camera
    {{.rays = 1}, {.words = 3}},                                   // trace
    {{.vertices = 1, .densities = 2, .rays = 1},
     {.vertices = 1, .densities = 1, .words = 3}},  // arrive, light
    {{.vertices = 1, .densities = 2, .rays = 1},
     {.vertices = 1, .densities = 1, .words = 3}},               // arrive, camera
    {{.vertices = 1, .densities = 1, .words = 1}, {.ends = 1}},  // list ends
    {{.vertices = 1, .densities = 1}, {.ends = 1}},              // list starts
    {{.vertices = 1, .densities = 1}, {}},                       // meet lights
    {{}, {.rays = 2, .words = 4}},                               // begin segments
    {{.rays = 1}, {.vertices = 1, .densities = 1}},              // end segments
    {{.vertices = 2, .densities = 2, .rays = 2, .segments = 1},
     {.ends = 1, .segments = 1, .sides = 1, .words = 9}},  // put segments
    {{.densities = 2, .segments = 1, .sides = 3, .words = 2},
     {.segments = 1, .words = 4}},                                        // gather sides
    {{.vertices = 1, .densities = 1}, {.words = 1}},                      // choose next events
    {{.vertices = 1, .densities = 1, .words = 2}, {.words = 2}},          // choose connections
    {{.vertices = 2, .densities = 1}, {.words = 1}},                      // choose splats
    {{.vertices = 1, .segments = 1, .words = 2}, {.words = 2}},           // choose sides
    {{.vertices = 1, .densities = 1, .segments = 1}, {.words = 1}},       // choose seen
    {{.words = 3}, {.words = 3}},                                         // choose segments
    {{.segments = 1}, {.words = 1}},                                      // flag lit
    {{.words = 2}, {.words = 1}},                                         // list lit
    {{.vertices = 1, .densities = 1, .words = 2}, {.words = 2}},          // estimate segments
    {{.vertices = 1, .connections = 1, .words = 1}, {.scatterings = 1}},  // scatter ends
    {{.vertices = 2, .densities = 2, .connections = 1, .scatterings = 2, .words = 1},
     {.connections = 1, .words = 4}},  // see
    {{.vertices = 2, .densities = 2, .connections = 1, .scatterings = 2, .words = 1},
     {}},  // connect
    {{.vertices = 2, .densities = 3, .connections = 1, .scatterings = 2, .words = 1},
     {.sides = 1}},  // connect sides
    {{.vertices = 2,
      .densities = 2,
      .connections = 1,
      .scatterings = 2,
      .segments = 1,
      .sides = 3,
      .words = 1},
     {.words = 1}},  // connect segments
}};

double bytes_of(const Records& r, bool layered) {
  const size_t vertex = sizeof(shader::PathVertex) + (layered ? sizeof(shader::PathBsdf) : 0);
  const auto all = [](int n, size_t size) { return n * static_cast<double>(size); };
  return all(r.vertices, vertex) + all(r.densities, sizeof(shader::PathDensity)) +
         all(r.rays, sizeof(shader::WalkRay)) + all(r.connections, sizeof(shader::Connection)) +
         all(r.scatterings, sizeof(shader::Scattering)) +
         all(r.ends, sizeof(shader::ConnectionEnd)) +
         all(r.segments, sizeof(shader::PortalSegment)) +
         all(r.sides, sizeof(shader::SegmentSide)) + all(r.words, sizeof(uint32_t));
}

}  // namespace

Traffic traffic_of(const DeviceWork& work, uint64_t connections, bool layered) {
  Traffic t;
  for (size_t i = 0; i < kTouched.size(); ++i) {
    const auto n = static_cast<double>(work.steps[i].invocations);
    t.read += n * bytes_of(kTouched[i].read, layered);
    t.written += n * bytes_of(kTouched[i].written, layered);
  }
  // The index of each, the end it stands for, and the estimate, which some store.
  const auto estimates = static_cast<double>(connections);
  t.read += estimates * (sizeof(shader::ConnectionEnd) + 2 * sizeof(uint32_t));
  t.written += estimates * sizeof(uint32_t);
  // Scans read and write flags and ranks twice; what they find is written to a list.
  const auto flagged = static_cast<double>(work.gather.invocations);
  t.read += flagged * 5 * sizeof(uint32_t);
  t.written += flagged * 3 * sizeof(uint32_t);
  return t;
}

}  // namespace tdpt
