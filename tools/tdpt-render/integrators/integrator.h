// The integrators, one table row each: a row defines an integrator completely [mixture.h].
#pragma once
#include <array>
#include <string>
#include <string_view>

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

/// Share of the samples that make a light walk, where not all do: about as efficient as any value
/// from 1/2 to 1/8, and a picture without depth limit takes 0.75 to 0.85 of the time.
inline constexpr double kFewLightWalks = 0.25;

/// In the order of the paper.
inline constexpr std::array kIntegrators{
    /// Path tracing: walk from the camera until it hits a light.
    Integrator{"pt", stream::pt, {TechniqueSet(Technique::camera)}},
    /// Path tracing with next-event estimation at every vertex.
    Integrator{"nee", stream::nee, {TechniqueSet(Technique::camera, Technique::direct)}},
    /// Bidirectional path tracing (Veach).
    Integrator{"bdpt", stream::bdpt, {kTwoWays}},
    /// bdpt plus portal segments: the paper's TDPT-ORG, each segment split once.
    Integrator{"tdpt-org", stream::tdpt_org, {kThreeWays}},
    /// Portal segments instead of the bi-connections: the paper's refined TDPT, section 3.
    Integrator{
        "tdpt",
        stream::tdpt,
        {TechniqueSet(Technique::camera, Technique::direct, Technique::light, Technique::portal)}},
    /// The techniques of tdpt-org, with both walks guided towards the portals [guide.h]; half of
    /// the
    /// light walks, since most lamps of a building do not see the openings of the camera's room.
    Integrator{"tdpt-guided",
               stream::tdpt_guided,
               {kThreeWays, 6, 2, 0.25, {{0.5, 0.4}}, kThroughWindows, kFewLightWalks}}};

/// The row of that name; null if there is none.
constexpr const Integrator* find_integrator(std::string_view name) {
  for (const Integrator& integrator : kIntegrators)
    if (name == integrator.name) return &integrator;
  return nullptr;
}
// Rows that the code refers to.
inline constexpr const Integrator& pt = *find_integrator("pt");
inline constexpr const Integrator& nee = *find_integrator("nee");
inline constexpr const Integrator& bdpt = *find_integrator("bdpt");
inline constexpr const Integrator& tdpt_org = *find_integrator("tdpt-org");
inline constexpr const Integrator& tdpt_ref = *find_integrator("tdpt");
inline constexpr const Integrator& tdpt_guided = *find_integrator("tdpt-guided");

/// Throws UsageError for an unknown name.
const Integrator& integrator_named(const std::string& name);

/// The name; for guided walks also the guiding probabilities and the share of samples with
/// segments; and the share with light walks if not all have one: "tdpt-guided 0.5 0.4 0.25, light
/// walks 0.25".
std::string label_of(const Integrator& integrator);

/// A sentence about light of the scene that none of the integrator's techniques can sample
/// (tdpt-render(1), INTEGRATORS); empty if there is none.
std::string light_missed(const Integrator& integrator, const Scene& scene);

}  // namespace tdpt
