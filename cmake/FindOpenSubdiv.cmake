# The part of OpenSubdiv that computes without a GPU. Its own CMake package also needs the other part,
# and links OpenMP. Defines OpenSubdiv::osdCPU.
include(FindPackageHandleStandardArgs)
find_path(OpenSubdiv_INCLUDE_DIR opensubdiv/far/primvarRefiner.h)
find_library(OpenSubdiv_LIBRARY osdCPU)
if(OpenSubdiv_INCLUDE_DIR)
  set(OpenSubdiv_VERSION)
  file(STRINGS "${OpenSubdiv_INCLUDE_DIR}/opensubdiv/version.h" lines
       REGEX "^#define OPENSUBDIV_VERSION_(MAJOR|MINOR|PATCH) ")
  foreach(line IN LISTS lines)
    string(REGEX MATCH "[0-9]+$" part "${line}")
    list(APPEND OpenSubdiv_VERSION "${part}")
  endforeach()
  list(JOIN OpenSubdiv_VERSION "." OpenSubdiv_VERSION)
endif()
find_package_handle_standard_args(OpenSubdiv
  REQUIRED_VARS OpenSubdiv_LIBRARY OpenSubdiv_INCLUDE_DIR VERSION_VAR OpenSubdiv_VERSION)
if(OpenSubdiv_FOUND AND NOT TARGET OpenSubdiv::osdCPU)
  add_library(OpenSubdiv::osdCPU UNKNOWN IMPORTED)
  set_target_properties(OpenSubdiv::osdCPU PROPERTIES
    IMPORTED_LOCATION "${OpenSubdiv_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${OpenSubdiv_INCLUDE_DIR}")
endif()
mark_as_advanced(OpenSubdiv_INCLUDE_DIR OpenSubdiv_LIBRARY)
