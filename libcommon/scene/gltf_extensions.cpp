// Extensions that a renderer of still pictures may pass over, even where a file requires them.
#include <algorithm>
#include <array>

#include "libcommon/scene/gltf_document.h"

namespace tdpt::gltf {
namespace {

constexpr std::array kNames = {
    // Other materials to choose from, other levels of detail: what the nodes name is drawn.
    "KHR_materials_variants", "MSFT_lod",
    // Motion of what is no node: only nodes move, and are told so.
    "KHR_animation_pointer",
    // What can be touched.
    "KHR_interactivity", "KHR_node_hoverability", "KHR_node_selectability", "AGI_articulations",
    // Metadata.
    "KHR_xmp", "KHR_xmp_json_ld", "AGI_stk_metadata", "EXT_feature_metadata",
    "EXT_instance_features", "EXT_mesh_features", "EXT_structural_metadata", "FB_geometry_metadata",
    "VRM", "VRMC_node_constraint", "VRMC_springBone", "VRMC_vrm",
    // Bodies and sound.
    "KHR_audio_emitter", "KHR_physics_rigid_bodies", "MSFT_audio_emitter", "OMI_collider",
    "OMI_physics_body", "OMI_physics_joint", "OMI_physics_shape",
    // How surfaces were made, and in which order a rasteriser draws them.
    "ADOBE_render_order", "CESIUM_primitive_outline", "EXT_mesh_manifold", "FB_ngon_encoding",
    "GODOT_single_root"};

}  // namespace

bool changes_no_picture(const std::string& extension) {
  return std::find(kNames.begin(), kNames.end(), extension) != kNames.end();
}

}  // namespace tdpt::gltf
