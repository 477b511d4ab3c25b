// KHR_lights_punctual. Internal to this room.
#pragma once
#include <optional>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// The light that a node holds, in metres as yet: position [m], intensity of points and spots
/// [W/sr]. Nothing when it holds none or one without intensity, or when the node's transform leaves
/// a spot or directional light no direction: then `flat` counts it.
std::optional<PunctualLight> read_light(const Document& document, const PlacedNode& node,
                                        size_t& flat);

/// asset.generator; empty: not told.
std::string generator_of(const Document& document);

/// What the numbers of the file's lamps stand for.
LampUnits lamp_units_of(const Document& document);

/// Brings a light to the canonical frame. Throws InputError when its intensity is too large or too
/// small for single precision there.
void to_canonical(const Document& document, const Frame& frame, PunctualLight& light);

}  // namespace tdpt::gltf
