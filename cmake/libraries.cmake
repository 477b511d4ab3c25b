# Origin shown by `<tool> --version`: the commit, and the libraries that the tool's targets link, directly or through a
# room.
include(commit)
tdpt_commit(${CMAKE_SOURCE_DIR} TDPT_COMMIT)

# Versions that no package provides are in a header.
find_path(TDPT_STB_FOLDER stb/stb_image_write.h)
function(tdpt_version_of_stb out)
  set(line "")
  if(TDPT_STB_FOLDER)
    file(STRINGS ${TDPT_STB_FOLDER}/stb/stb_image_write.h line LIMIT_COUNT 1)
  endif()
  string(REGEX MATCH "[0-9.]*[0-9]" version "${line}")
  set(${out} "${version}" PARENT_SCOPE)
endfunction()
function(tdpt_version_of_openmesh out)
  get_target_property(folder OpenMeshCore INTERFACE_INCLUDE_DIRECTORIES)
  set(line "")
  set(${out} "" PARENT_SCOPE)
  if(EXISTS ${folder}/OpenMesh/Core/System/config.h)
    file(STRINGS ${folder}/OpenMesh/Core/System/config.h line REGEX "^#define OM_VERSION 0x")
  endif()
  # 0x90000 is 9.0.0, 0x0B0000 is 11.0.0.
  if(line MATCHES "0x[0-9A-Fa-f]+$")
    math(EXPR major "${CMAKE_MATCH_0} >> 16")
    math(EXPR minor "(${CMAKE_MATCH_0} >> 8) & 255")
    math(EXPR patch "${CMAKE_MATCH_0} & 255")
    set(${out} "${major}.${minor}.${patch}" PARENT_SCOPE)
  endif()
endfunction()

# tdpt_library_name(link out): name and version of a linked library; "" for parts of the C library.
function(tdpt_library_name link out)
  tdpt_version_of_stb(stb_VERSION)
  tdpt_version_of_openmesh(OpenMesh_VERSION)
  set(names
    Boost::headers "Boost ${Boost_VERSION}"
    CGAL::CGAL "CGAL ${CGAL_VERSION}"
    CLI11::CLI11 "CLI11 ${CLI11_VERSION}"
    OpenEXR::OpenEXR "OpenEXR ${OpenEXR_VERSION}"
    OpenMeshCore "OpenMesh ${OpenMesh_VERSION}"
    OpenVDB::openvdb "OpenVDB ${OpenVDB_VERSION}"
    PkgConfig::PANGOCAIRO "Pango ${PANGOCAIRO_VERSION}"
    PkgConfig::WEBP "libwebp ${WEBP_VERSION}"
    TBB::tbb "oneTBB ${TBB_VERSION}"
    Vulkan::Headers "Vulkan-Headers ${Vulkan_VERSION}"
    Xxhash::xxhash "xxHash ${Xxhash_VERSION}"
    ZLIB::ZLIB "zlib ${ZLIB_VERSION_STRING}"
    draco::draco "Draco ${draco_VERSION}"
    embree "Embree ${embree_VERSION}"
    fmt::fmt "fmt ${fmt_VERSION}"
    meshoptimizer::meshoptimizer "meshoptimizer ${meshoptimizer_VERSION}"
    nlohmann_json::nlohmann_json "nlohmann_json ${nlohmann_json_VERSION}"
    pugixml::pugixml "pugixml ${pugixml_VERSION}"
    stb "stb_image_write ${stb_VERSION}"
    dl "-")
  list(FIND names "${link}" at)
  if(at LESS 0)
    message(FATAL_ERROR "${link} is linked: say in cmake/libraries.cmake what --version calls it")
  endif()
  math(EXPR at "${at} + 1")
  list(GET names ${at} name)
  if(name MATCHES " $")
    message(FATAL_ERROR "The version of ${link} is not found")
  endif()
  string(REGEX REPLACE "^-$" "" name "${name}")
  set(${out} "${name}" PARENT_SCOPE)
endfunction()

# tdpt_linked_by(target out): foreign libraries that a target links, directly or through ours.
function(tdpt_linked_by target out)
  set(linked "")
  set(seen ${target})
  set(left ${target})
  while(left)
    list(POP_FRONT left ours)
    get_target_property(type ${ours} TYPE)
    if(type STREQUAL INTERFACE_LIBRARY)
      get_target_property(links ${ours} INTERFACE_LINK_LIBRARIES)
    else()
      get_target_property(links ${ours} LINK_LIBRARIES)
    endif()
    foreach(link IN LISTS links)
      if(NOT link OR link IN_LIST seen)
        continue()
      endif()
      list(APPEND seen ${link})
      set(imported TRUE)
      if(TARGET ${link})
        get_target_property(imported ${link} IMPORTED)
      endif()
      if(imported)
        list(APPEND linked ${link})
      else()
        list(APPEND left ${link})
      endif()
    endforeach()
  endwhile()
  set(${out} "${linked}" PARENT_SCOPE)
endfunction()

# tdpt_tell_origin(tool): writes generated/<tool>/built_with.cpp, which defines kLibraries of libcommon/cli/cli.h. Call it
# after all libraries of the tool are declared.
function(tdpt_tell_origin tool)
  tdpt_linked_by(${tool} linked)
  set(names "")
  foreach(link IN LISTS linked)
    tdpt_library_name(${link} name)
    list(APPEND names ${name})
  endforeach()
  list(SORT names CASE INSENSITIVE)
  list(JOIN names "\\n\"\n    \"" text)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/${tool}/built_with.cpp CONTENT
"#include \"libcommon/cli/cli.h\"
namespace tdpt::cli {
const char kLibraries[] =
    \"@text@\\n\";
const char kCommit[] = \"@TDPT_COMMIT@\";
}  // namespace tdpt::cli
" @ONLY)
endfunction()
