// The integrators: a row of a table each. What a row says is all there is to one [mixture.h].
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "libcommon/math/streams.h"
#include "libcommon/scene/scene.h"
#include "tools/tdpt-render/path/sample/mixture.h"

namespace tdpt {

struct Integrator {
  const char* name;
  uint64_t stream;  ///< below kStreams: no two rows share samples
  Mixture mixture;
};

inline constexpr TechniqueSet kTwoWays(Technique::camera, Technique::direct, Technique::light,
                                       Technique::bi);
inline constexpr TechniqueSet kThreeWays = kTwoWays | TechniqueSet(Technique::portal);

/// Share of the samples that make a light walk, where not all do: about as good as any from 1/2 to
/// 1/8, and the picture without limit takes 0.75 to 0.85 of the time.
inline constexpr double kFewLightWalks = 0.25;

/// In the order of the paper.
inline constexpr std::array kIntegrators{
    /// Path tracing: walk from the camera until a light is met.
    Integrator{"pt", stream::pt, {TechniqueSet(Technique::camera)}},
    /// And next-event estimation at every vertex.
    Integrator{"nee", stream::nee, {TechniqueSet(Technique::camera, Technique::direct)}},
    /// Bidirectional path tracing (Veach).
    Integrator{"bdpt", stream::bdpt, {kTwoWays}},
    /// Portal segments on top: the paper's TDPT-ORG, each split once.
    Integrator{"tdpt-org", stream::tdpt_org, {kThreeWays}},
    /// Portal segments in place of the bi-connections: the paper's refined TDPT, section 3.
    Integrator{
        "tdpt",
        stream::tdpt,
        {TechniqueSet(Technique::camera, Technique::direct, Technique::light, Technique::portal)}},
    /// The techniques of tdpt-org with both walks directed at the portals [guide.h].
    Integrator{"tdpt-guided",
               stream::tdpt_guided,
               {kThreeWays, 6, 2, 0.25, {{0.7, 0.4}}, kThroughWindows, kFewLightWalks}}};

/// The row of that name; null when there is none.
constexpr const Integrator* find_integrator(std::string_view name) {
  for (const Integrator& integrator : kIntegrators)
    if (name == integrator.name) return &integrator;
  return nullptr;
}
// Those that the code speaks of.
inline constexpr const Integrator& pt = *find_integrator("pt");
inline constexpr const Integrator& nee = *find_integrator("nee");
inline constexpr const Integrator& bdpt = *find_integrator("bdpt");
inline constexpr const Integrator& tdpt_org = *find_integrator("tdpt-org");
inline constexpr const Integrator& tdpt_ref = *find_integrator("tdpt");
inline constexpr const Integrator& tdpt_guided = *find_integrator("tdpt-guided");

/// Throws UsageError for a name that there is not.
const Integrator& integrator_named(const std::string& name);

/// Its name, and if its walks are directed, how, and the share of samples with segments; that with
/// light walks where not all have one: "tdpt-guided 0.7 0.4 0.25, light walks 0.25".
std::string label_of(const Integrator& integrator);

/// A sentence about light that the scene has and none of the integrator's techniques can make
/// (tdpt(7), "Lamps without surface"); empty when there is none to speak of.
std::string light_missed(const Integrator& integrator, const Scene& scene);

}  // namespace tdpt
