# Debian's own find module requires boost-iostreams, which libopenvdb-dev does not install.
find_path(OpenVDB_INCLUDE_DIR openvdb/openvdb.h)
find_library(OpenVDB_LIBRARY openvdb)
if(OpenVDB_INCLUDE_DIR)
  file(STRINGS ${OpenVDB_INCLUDE_DIR}/openvdb/version.h _lines REGEX "OPENVDB_LIBRARY_(MAJOR|MINOR|PATCH)_VERSION_NUMBER [0-9]+")
  foreach(_line ${_lines})
    string(REGEX MATCH "[0-9]+$" _n ${_line})
    list(APPEND _version ${_n})
  endforeach()
  list(JOIN _version "." OpenVDB_VERSION)
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenVDB REQUIRED_VARS OpenVDB_LIBRARY OpenVDB_INCLUDE_DIR
                                  VERSION_VAR OpenVDB_VERSION)
if(OpenVDB_FOUND AND NOT TARGET OpenVDB::openvdb)
  find_package(Imath CONFIG REQUIRED)
  add_library(OpenVDB::openvdb UNKNOWN IMPORTED)
  set_target_properties(OpenVDB::openvdb PROPERTIES
    IMPORTED_LOCATION ${OpenVDB_LIBRARY}
    INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${OpenVDB_INCLUDE_DIR}
    INTERFACE_LINK_LIBRARIES "TBB::tbb;Imath::Imath")
endif()
