// Extensions by name: those that are read, and those that a renderer of still pictures may ignore
// even if a file requires them.
#include <algorithm>
#include <array>

#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {
namespace {

constexpr std::array kSupported = {"KHR_materials_emissive_strength",
                                   "KHR_materials_specular",
                                   "KHR_materials_ior",
                                   "KHR_materials_transmission",
                                   "KHR_materials_volume",
                                   "KHR_materials_clearcoat",
                                   "KHR_materials_sheen",
                                   "KHR_materials_iridescence",
                                   "KHR_materials_anisotropy",
                                   "KHR_materials_dispersion",
                                   "KHR_materials_diffuse_transmission",
                                   "KHR_materials_volume_scatter",
                                   "KHR_materials_unlit",
                                   "KHR_lights_punctual",
                                   "EXT_lights_ies",
                                   "EXT_lights_area",
                                   "KHR_mesh_quantization",
                                   "KHR_draco_mesh_compression",
                                   "EXT_meshopt_compression",
                                   "KHR_meshopt_compression",
                                   "EXT_texture_webp",
                                   "EXT_texture_avif",
                                   "KHR_texture_basisu",
                                   "MSFT_texture_dds",
                                   "KHR_texture_transform",
                                   "KHR_materials_pbrSpecularGlossiness",
                                   "KHR_node_visibility",
                                   "EXT_mesh_gpu_instancing"};

constexpr std::array kOfNoPicture = {
    // Alternative materials and levels of detail: what the nodes refer to is rendered.
    "KHR_materials_variants", "MSFT_lod",
    // Animates properties outside of nodes; only animations of nodes are evaluated.
    "KHR_animation_pointer",
    // Interaction.
    "KHR_interactivity", "KHR_node_hoverability", "KHR_node_selectability", "AGI_articulations",
    // Metadata.
    "KHR_xmp", "KHR_xmp_json_ld", "AGI_stk_metadata", "EXT_feature_metadata",
    "EXT_instance_features", "EXT_mesh_features", "EXT_structural_metadata", "FB_geometry_metadata",
    "VRM", "VRMC_node_constraint", "VRMC_springBone", "VRMC_vrm",
    // Physics and sound.
    "KHR_audio_emitter", "KHR_physics_rigid_bodies", "MSFT_audio_emitter", "OMI_collider",
    "OMI_physics_body", "OMI_physics_joint", "OMI_physics_shape",
    // Modelling history, and the drawing order of rasterisers.
    "ADOBE_render_order", "CESIUM_primitive_outline", "EXT_mesh_manifold", "FB_ngon_encoding",
    "GODOT_single_root",
    // An offset of the whole scene, cameras and lamps included.
    "CESIUM_RTC"};

}  // namespace

bool is_supported(const std::string& extension) {
  return std::find(kSupported.begin(), kSupported.end(), extension) != kSupported.end();
}

bool changes_no_picture(const std::string& extension) {
  return std::find(kOfNoPicture.begin(), kOfNoPicture.end(), extension) != kOfNoPicture.end();
}

}  // namespace tdpt::gltf
